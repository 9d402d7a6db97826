use algos_nostd::clip::{Point, Window};
use algos_nostd::image::{Error, Rgb};

use super::table::Parameter;
use super::value::{Place, Value};

/// The values of a stage's parameters, by name.
///
/// # Panics
/// All of it, if a stage asks for a parameter that it does not declare, or for another kind: a test runs every stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arguments<'a> {
    pub(super) parameters: &'static [Parameter],
    pub(super) values: &'a [Value],
}

impl<'a> Arguments<'a> {
    fn value(&self, name: &str) -> &'a Value {
        let index = self.parameters.iter().position(|parameter| parameter.name == name);
        match index.and_then(|index| self.values.get(index)) {
            Some(value) => value,
            None => panic!("the stage does not declare `{name}`"),
        }
    }

    pub(super) fn integer<T: TryFrom<i64>>(&self, name: &str) -> T {
        match self.value(name) {
            Value::Integer(number) => T::try_from(*number).ok(),
            _ => None,
        }
        .unwrap_or_else(|| panic!("`{name}` is not declared as such an integer"))
    }

    /// In thousandths.
    pub(super) fn milli<T: TryFrom<i64>>(&self, name: &str) -> T {
        match self.value(name) {
            Value::Decimal(number) => T::try_from(*number).ok(),
            _ => None,
        }
        .unwrap_or_else(|| panic!("`{name}` is not declared as such a number"))
    }

    pub(super) fn word(&self, name: &str) -> &'static str {
        if let Value::Word(word) = self.value(name) {
            word
        } else {
            panic!("`{name}` is not declared as a word")
        }
    }

    pub(super) fn is(&self, name: &str, word: &str) -> bool {
        self.word(name) == word
    }

    pub(super) fn color(&self, name: &str) -> Rgb {
        if let Value::Color(color) = self.value(name) {
            *color
        } else {
            panic!("`{name}` is not declared as a colour")
        }
    }

    pub(super) fn colors(&self, name: &str) -> &'a [Rgb] {
        if let Value::Colors(colors) = self.value(name) {
            colors
        } else {
            panic!("`{name}` is not declared as colours")
        }
    }

    pub(super) fn text(&self, name: &str) -> &'a str {
        if let Value::Text(text) = self.value(name) {
            text
        } else {
            panic!("`{name}` is not declared as a text")
        }
    }

    pub(super) fn pairs(&self, name: &str) -> &'a [(u8, u8)] {
        if let Value::Pairs(pairs) = self.value(name) {
            pairs
        } else {
            panic!("`{name}` is not declared as pairs")
        }
    }

    /// In thousandths.
    pub(super) fn numbers(&self, name: &str) -> &'a [i64] {
        if let Value::Numbers(numbers) = self.value(name) {
            numbers
        } else {
            panic!("`{name}` is not declared as numbers")
        }
    }

    /// The first numbers as whole ones; what is behind the point is cut off.
    pub(super) fn whole<T: TryFrom<i64> + Default + Copy, const COUNT: usize>(
        &self,
        name: &str,
    ) -> [T; COUNT] {
        let mut whole = [T::default(); COUNT];
        for (slot, number) in whole.iter_mut().zip(self.numbers(name)) {
            *slot = T::try_from(number / 1000).unwrap_or_default();
        }
        whole
    }

    fn place(&self, name: &str) -> Place {
        if let Value::Place(place) = self.value(name) {
            *place
        } else {
            panic!("`{name}` is not declared as a place")
        }
    }

    /// The pixel in a picture of that size.
    pub(super) fn point(&self, name: &str, size: (usize, usize)) -> Point {
        self.place(name).point(size)
    }

    /// Width and height in a picture of that size.
    pub(super) fn extent(&self, name: &str, size: (usize, usize)) -> (usize, usize) {
        self.place(name).extent(size)
    }

    /// The pixels in a picture of that size.
    pub(super) fn points(&self, name: &str, size: (usize, usize)) -> Vec<Point> {
        match self.value(name) {
            Value::Places(places) => places.iter().map(|place| place.point(size)).collect(),
            _ => panic!("`{name}` is not declared as places"),
        }
    }

    /// The rectangle between the first two places, whichever corners they are.
    pub(super) fn window(&self, name: &str, size: (usize, usize)) -> Result<Window, Error> {
        let corners = self.points(name, size);
        let [a, b] = [corners.first(), corners.last()].map(|corner| corner.copied().unwrap_or_default());
        Window::new(Point::new(a.x.min(b.x), a.y.min(b.y)), Point::new(a.x.max(b.x), a.y.max(b.y)))
    }
}
