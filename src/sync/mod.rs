//! Made from machine words only: locks, rings, counters, barriers, quiescence.
