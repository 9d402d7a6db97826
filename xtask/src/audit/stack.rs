//! A bound on the stack: the deepest way through the calls, and every interrupt on top of it.
//!
//! ```text
//! main ─► … ─► deepest call
//!                   ├─ exception frame, handler ─► its deepest call
//!                   │        ├─ exception frame, the next handler ─► …
//! ```
//!
//! Every handler is taken to interrupt all others once, whatever the priorities: more than the core can do. A handler that
//! serves interrupts of several priorities counts once for each, which a rule must say.

use std::collections::{BTreeMap, BTreeSet};

use super::code::Summary;
use super::program::{Function, Program};
use super::rules::Rules;

/// What the core pushes: 26 words with the registers for floats, and one to align (Armv7-M ARM, B1.5.7).
const EXCEPTION_FRAME: u32 = 26 * 4 + 4;

/// The functions and who calls whom.
#[derive(Debug)]
pub(super) struct Graph<'p> {
    program: &'p Program,
    frames: BTreeMap<u32, u32>,
    callees: BTreeMap<u32, BTreeSet<u32>>,
    /// What stands in the way of a bound.
    pub(super) unclear: Vec<String>,
}

/// A bound on an image's stack, in bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bound {
    /// From the reset vector on.
    pub(crate) main: u32,
    /// Each handler with its exception frame.
    pub(crate) handlers: Vec<(String, u32)>,
    /// The way that is deepest, each function with its own bytes.
    pub(crate) deepest: Vec<(String, u32)>,
}

impl Bound {
    /// Of all interrupts together.
    pub(crate) fn interrupts(&self) -> u32 {
        self.handlers.iter().map(|(_, bytes)| bytes).sum()
    }

    /// Of everything.
    pub(crate) fn total(&self) -> u32 {
        self.main + self.interrupts()
    }
}

impl<'p> Graph<'p> {
    /// Joins what the functions say with what the rules say.
    pub(super) fn new(program: &'p Program, summaries: &BTreeMap<u32, Summary>, rules: &Rules) -> Self {
        let mut taken = program.taken();
        let made = summaries.values().flat_map(|summary| &summary.made).filter(|&&word| word & 1 == 1);
        taken.extend(made.filter_map(|word| program.function_at(*word)).map(|function| function.place.start));
        let mut graph =
            Self { program, frames: BTreeMap::new(), callees: BTreeMap::new(), unclear: Vec::new() };
        for function in program.functions() {
            let Some(summary) = summaries.get(&function.place.start) else { continue };
            let mut callees: BTreeSet<u32> = summary.calls.iter().map(|&(_, target)| target).collect();
            if !summary.indirect.is_empty() {
                callees.extend(graph.reached(function, summary, rules, &taken));
            }
            graph.frames.insert(function.place.start, summary.frame);
            graph.callees.insert(function.place.start, callees);
            graph.unclear.extend(summary.unclear.iter().cloned());
        }
        graph
    }

    /// Whom a function's calls by address reach, by the rules.
    fn reached(
        &mut self,
        function: &Function,
        summary: &Summary,
        rules: &Rules,
        taken: &BTreeSet<u32>,
    ) -> BTreeSet<u32> {
        let mut reached = BTreeSet::new();
        let mut known = false;
        for rule in rules.indirect.iter().filter(|rule| function.name.contains(&rule.from)) {
            known = true;
            for part in &rule.to {
                let matching = taken.iter().filter(|&&address| self.name(address).contains(part.as_str()));
                reached.extend(matching);
            }
        }
        if !known {
            let at = summary.indirect.first().copied().unwrap_or_default();
            self.unclear.push(format!("{}, {at:#x}: calls by address, and no rule says whom", function.name));
        }
        reached
    }

    fn name(&self, address: u32) -> &'p str {
        self.program.function_at(address).map_or("?", |function| &function.name)
    }

    /// The bound, if nothing is unclear.
    pub(super) fn bound(&mut self, rules: &Rules) -> Bound {
        let components = self.components();
        let mut depths = Depths::default();
        for component in &components {
            self.settle(component, rules, &mut depths);
        }
        let vectors = &self.program.vectors;
        let depth = |address: u32| depths.bytes.get(&(address & !1)).copied().unwrap_or(0);
        let reset = vectors.get(1).copied().unwrap_or(0);
        let handlers: BTreeSet<u32> = vectors.iter().skip(2).copied().filter(|&vector| vector != 0).collect();
        let handlers = handlers.into_iter().map(|address| {
            let name = self.name(address);
            let times = rules.nesting.iter().find(|rule| rule.handler == name).map_or(1, |rule| rule.times);
            (name.to_owned(), times * (EXCEPTION_FRAME + depth(address)))
        });
        let handlers = handlers.collect();
        let mut deepest = Vec::new();
        let mut next = Some(reset & !1);
        while let Some(address) = next {
            deepest.push((self.name(address).to_owned(), depths.own.get(&address).copied().unwrap_or(0)));
            next = depths.next.get(&address).copied().filter(|_| deepest.len() < 64);
        }
        Bound { main: depth(reset), handlers, deepest }
    }

    /// Settles functions that call each other, whose callees are settled.
    fn settle(&mut self, component: &[u32], rules: &Rules, depths: &mut Depths) {
        let own: u32 = component.iter().map(|address| self.frames.get(address).copied().unwrap_or(0)).sum();
        let callees = component.iter().filter_map(|address| self.callees.get(address)).flatten();
        let inner = callees.clone().any(|callee| component.contains(callee));
        let deepest = callees
            .filter(|callee| !component.contains(callee))
            .max_by_key(|callee| depths.bytes.get(callee).copied().unwrap_or(0));
        let below = deepest.and_then(|callee| depths.bytes.get(callee)).copied().unwrap_or(0);
        let mut turns = 1;
        if inner {
            let names: Vec<&str> = component.iter().map(|&address| self.name(address)).collect();
            let known =
                rules.recursion.iter().find(|rule| names.iter().any(|name| name.contains(&rule.through)));
            match known {
                Some(rule) => turns = rule.depth,
                None => self.unclear.push(format!("recursion without a rule: {}", names.join(", "))),
            }
        }
        for &address in component {
            depths.bytes.insert(address, own * turns + below);
            depths.own.insert(address, own * turns);
            if let Some(&deepest) = deepest {
                depths.next.insert(address, deepest);
            }
        }
    }

    /// Functions that call each other, callees first (Tarjan 1972), without recursion of our own.
    fn components(&self) -> Vec<Vec<u32>> {
        let mut search = Search::default();
        for &root in self.callees.keys() {
            if search.index.contains_key(&root) {
                continue;
            }
            let mut path: Vec<(u32, Vec<u32>)> = vec![(root, search.enter(root, &self.callees))];
            while let Some((address, left)) = path.last_mut() {
                let address = *address;
                if let Some(callee) = left.pop() {
                    if !search.index.contains_key(&callee) {
                        let callees = search.enter(callee, &self.callees);
                        path.push((callee, callees));
                    } else if search.open.contains(&callee) {
                        let index = search.index[&callee];
                        search.lower(address, index);
                    }
                } else {
                    path.pop();
                    let low = search.low[&address];
                    if let Some((parent, _)) = path.last() {
                        search.lower(*parent, low);
                    }
                    search.leave(address);
                }
            }
        }
        search.found
    }
}

/// What is known of the settled functions.
#[derive(Debug, Default)]
struct Depths {
    bytes: BTreeMap<u32, u32>,
    own: BTreeMap<u32, u32>,
    next: BTreeMap<u32, u32>,
}

/// Tarjan's search.
#[derive(Debug, Default)]
struct Search {
    index: BTreeMap<u32, usize>,
    low: BTreeMap<u32, usize>,
    open: BTreeSet<u32>,
    stack: Vec<u32>,
    found: Vec<Vec<u32>>,
}

impl Search {
    fn enter(&mut self, address: u32, callees: &BTreeMap<u32, BTreeSet<u32>>) -> Vec<u32> {
        let index = self.index.len();
        self.index.insert(address, index);
        self.low.insert(address, index);
        self.open.insert(address);
        self.stack.push(address);
        callees.get(&address).map(|callees| callees.iter().copied().collect()).unwrap_or_default()
    }

    fn lower(&mut self, address: u32, to: usize) {
        if let Some(low) = self.low.get_mut(&address) {
            *low = (*low).min(to);
        }
    }

    fn leave(&mut self, address: u32) {
        if self.low[&address] != self.index[&address] {
            return;
        }
        let mut component = Vec::new();
        while let Some(member) = self.stack.pop() {
            self.open.remove(&member);
            component.push(member);
            if member == address {
                break;
            }
        }
        self.found.push(component);
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::Reader;
    use super::super::rules::Recursion;
    use super::*;

    /// `bl` at `from` to `to`, forwards or back by less than 1 KiB.
    fn bl(from: u32, to: u32) -> [u16; 2] {
        let offset = to.wrapping_sub(from + 4) >> 1;
        let back = u16::from(to < from);
        [0xF000 | back << 10 | if back == 1 { 0x3FF } else { 0 }, 0xF800 | (offset & 0x7FF) as u16]
    }

    fn bound(functions: &[(&str, &[u16])], vectors: &[u32], rules: &Rules) -> (Bound, Vec<String>) {
        let program = Program::of(functions, vectors);
        let reader = Reader::new().unwrap();
        let all = program.functions();
        let summaries =
            all.map(|function| (function.place.start, reader.summary(&program, function).unwrap()));
        let mut graph = Graph::new(&program, &summaries.collect(), rules);
        (graph.bound(rules), graph.unclear)
    }

    #[test]
    fn the_deepest_way_and_every_interrupt_are_summed() {
        let [a, b] = bl(0x102, 0x10A);
        let [c, d] = bl(0x106, 0x10E);
        let functions: [(&str, &[u16]); 4] = [
            ("main", &[0xB500, a, b, c, d]), // push {lr}; bl small; bl large
            ("small", &[0xB081, 0x4770]),
            ("large", &[0xB084, 0x4770]),
            ("handler", &[0xB082, 0x4770]),
        ];
        let (bound, unclear) = bound(&functions, &[0x2000_1000, 0x101, 0x113, 0x113], &Rules::default());
        assert_eq!((bound.main, bound.interrupts()), (4 + 16, EXCEPTION_FRAME + 8));
        assert_eq!(unclear, Vec::<String>::new());
        let names: Vec<_> = bound.deepest.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["main", "large"]);
    }

    #[test]
    fn recursion_and_calls_by_address_need_rules() {
        let [a, b] = bl(0x102, 0x100);
        let functions: [(&str, &[u16]); 2] = [("round", &[0xB500, a, b, 0xBF00]), ("by", &[0x4798])];
        let vectors = [0x2000_1000, 0x101];
        let (_, unclear) = bound(&functions, &vectors, &Rules::default());
        assert!(unclear[0].starts_with("by, 0x108: calls by address"), "{unclear:?}");
        assert_eq!(unclear[1], "recursion without a rule: round");
        let recursion = Recursion { through: "round".into(), depth: 3, reason: "three".into() };
        let (bound, unclear) =
            bound(&functions, &vectors, &Rules { recursion: vec![recursion], ..Rules::default() });
        assert_eq!((bound.main, unclear.len()), (12, 1));
    }
}
