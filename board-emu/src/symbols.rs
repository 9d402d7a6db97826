//! Names for addresses, from the image's own symbol table.

use object::{Object, ObjectSymbol, SymbolKind};

/// Functions by address.
#[derive(Clone, Debug, Default)]
pub struct Symbols(Vec<(u64, u64, String)>);

impl Symbols {
    /// Those of an ELF file; none if it has none or is no ELF.
    #[must_use]
    pub fn read(image: &[u8]) -> Self {
        let Ok(file) = object::File::parse(image) else { return Self::default() };
        let functions =
            file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
        let mut named: Vec<_> = functions
            .filter_map(|symbol| {
                let name = rustc_demangle::demangle(symbol.name().ok()?);
                // Bit 0 of a function's address says Thumb.
                Some((symbol.address() & !1, symbol.size(), without_generics(&format!("{name:#}"))))
            })
            .collect();
        named.sort();
        Self(named)
    }

    /// The function that holds an address, and how far into it the address lies.
    #[must_use]
    pub fn name(&self, address: u64) -> Option<(&str, u64)> {
        let after = self.0.partition_point(|(start, ..)| *start <= address);
        let (start, size, name) = self.0.get(after.checked_sub(1)?)?;
        (address < start + size).then(|| (name.as_str(), address - start))
    }

    /// The address in words: with its function, if it has one.
    #[must_use]
    pub fn describe(&self, address: u64) -> String {
        match self.name(address) {
            Some((name, offset)) => format!("{address:#010x} in {name} + {offset:#x}"),
            None => format!("{address:#010x}"),
        }
    }
}

/// A path without the types that its items were made for: `a::run::<T, U>` and `<a::B<T>>::run` without `T` and `U`.
fn without_generics(name: &str) -> String {
    let mut short = String::new();
    let mut depth = 0_usize;
    let mut before = ' ';
    for character in name.chars() {
        match character {
            // After a name or `::` types follow; anywhere else the name of a type with its trait.
            '<' if depth > 0 => depth += 1,
            '<' if before == ':' || before == '_' || before.is_alphanumeric() => {
                depth = 1;
                if short.ends_with("::") {
                    short.truncate(short.len() - 2);
                }
            }
            '>' if depth > 0 && before != '-' => depth -= 1,
            _ if depth == 0 => short.push(character),
            _ => {}
        }
        before = character;
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_short_enough_to_read() {
        let cases = [
            ("image::run::<I2c<A, B>, Output>", "image::run"),
            ("<frames::Frames<Port<Mmio>, 3>>::advance", "<frames::Frames>::advance"),
            ("<a::B<fn(u8) -> u8> as c::D<E>>::f", "<a::B as c::D>::f"),
            ("main", "main"),
        ];
        for (long, short) in cases {
            assert_eq!(without_generics(long), short);
        }
    }

    #[test]
    fn an_address_belongs_to_the_function_before_it() {
        let symbols = Symbols(vec![(0x100, 8, "main".into()), (0x110, 4, "wait".into())]);
        assert_eq!(symbols.name(0x106), Some(("main", 6)));
        assert_eq!(symbols.name(0x108), None);
        assert_eq!(symbols.describe(0x110), "0x00000110 in wait + 0x0");
        assert_eq!(symbols.describe(0x90), "0x00000090");
    }

    #[test]
    fn what_is_no_image_has_no_names() {
        assert_eq!(Symbols::read(b"nothing").name(0), None);
    }
}
