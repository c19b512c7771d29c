//! The header of a PLY file: which elements follow, how many of each, and what each is made of.

/// What is wrong, and what was expected instead.
pub(super) type Fault = (String, String);

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// What is given of each item of an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Property {
    Number { name: String, kind: Kind },
    List { name: String, count: Kind, item: Kind },
}

/// A table of items that are all made alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    /// How many items the header says there are. Nothing may be made that large before the items are seen.
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// The line of the header that says so, from 1.
    pub(super) line: usize,
}

/// A whole header.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Bytes it takes.
    pub(super) length: usize,
    /// Lines it takes.
    pub(super) lines: usize,
}

impl Kind {
    fn of(word: &str) -> Result<Self, Fault> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err((format!("type {word:?}"), "char, uchar ... float, double".to_string())),
        })
    }

    /// Its bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether it counts.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

impl Property {
    fn name(&self) -> &str {
        match self {
            Self::Number { name, .. } | Self::List { name, .. } => name,
        }
    }

    /// The fewest bytes it can take.
    fn least(&self, encoding: Encoding) -> usize {
        match (encoding, self) {
            // A digit and what parts it from the next.
            (Encoding::Text, _) => 2,
            (_, Self::Number { kind, .. } | Self::List { count: kind, .. }) => kind.size(),
        }
    }
}

impl Element {
    /// The fewest bytes an item can take; at least 1, as no element is without properties.
    pub(super) fn least(&self, encoding: Encoding) -> usize {
        self.properties.iter().map(|property| property.least(encoding)).sum()
    }

    /// Where the property of that name stands.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name() == name)
    }
}

/// Reads a header.
///
/// # Errors
/// The number of the line that is wrong, and how.
pub(super) fn read(bytes: &[u8]) -> Result<Header, (usize, Fault)> {
    let fail = |line, found: String, expected: &str| Err((line, (found, expected.to_string())));
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    let (mut length, mut line) = (0, 0);
    loop {
        line += 1;
        let Some(end) = bytes[length..].iter().position(|byte| *byte == b'\n') else {
            return fail(line, "the file ends within its header".to_string(), "end_header");
        };
        let text = String::from_utf8_lossy(&bytes[length..length + end]);
        length += end + 1;
        let words: Vec<&str> = text.split_whitespace().collect();
        match (line, words.as_slice()) {
            (1, ["ply"]) => {}
            (1, _) => return fail(line, shown(&text), "ply"),
            (_, []) | (_, ["comment" | "obj_info", ..]) => {}
            (_, ["format", format, "1.0"]) => {
                encoding = Some(match *format {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => {
                        let expected = "ascii, binary_little_endian or binary_big_endian";
                        return fail(line, shown(format), expected);
                    }
                });
            }
            (_, ["element", name, count]) => {
                let Ok(count) = count.parse() else {
                    return fail(line, format!("count {}", shown(count)), "a whole number");
                };
                if elements.iter().any(|element| element.name == *name) {
                    return fail(line, format!("a second element {name:?}"), "each element once");
                }
                elements.push(Element { name: name.to_string(), count, properties: Vec::new(), line });
            }
            (_, ["property", definition @ ..]) => {
                let property = property(definition).map_err(|fault| (line, fault))?;
                let Some(element) = elements.last_mut() else {
                    return fail(line, "a property of nothing".to_string(), "an element before it");
                };
                if element.position(property.name()).is_some() {
                    let found = format!("a second property {:?} of {}", property.name(), element.name);
                    return fail(line, found, "each property once");
                }
                element.properties.push(property);
            }
            (_, ["end_header"]) => break,
            _ => return fail(line, shown(&text), "format, element, property, comment or end_header"),
        }
    }
    if let Some(bare) = elements.iter().find(|element| element.properties.is_empty()) {
        return fail(bare.line, format!("element {:?} without properties", bare.name), "some");
    }
    match encoding {
        Some(encoding) => Ok(Header { encoding, elements, length, lines: line }),
        None => fail(line, "the header ends without a format".to_string(), "a line `format`"),
    }
}

fn property(definition: &[&str]) -> Result<Property, Fault> {
    match definition {
        ["list", count, item, name] => {
            let (count, item) = (Kind::of(count)?, Kind::of(item)?);
            if !count.is_whole() {
                return Err((
                    format!("list {name:?} with a count that is no whole number"),
                    "one".to_string(),
                ));
            }
            Ok(Property::List { name: name.to_string(), count, item })
        }
        [kind, name] => Ok(Property::Number { name: name.to_string(), kind: Kind::of(kind)? }),
        _ => {
            let expected = "property TYPE NAME or property list TYPE TYPE NAME";
            Err((shown(&definition.join(" ")), expected.to_string()))
        }
    }
}

/// A text for a message: of one that is no header at all, the beginning.
fn shown(text: &str) -> String {
    format!("{:?}", text.trim_end().chars().take(40).collect::<String>())
}
