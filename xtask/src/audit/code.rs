//! What a function's instructions say: whom it calls, and how deep it takes the stack.
//!
//! The depth is the sum of everything that moves the stack pointer down, wherever it stands in the function: more than
//! any one way through it can take. What moves the pointer in a way that is not understood is an error, never a guess.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, anyhow};
use capstone::arch::arm::{ArmCC, ArmInsnDetail, ArmOperandType, ArmReg};
use capstone::prelude::*;

use super::program::{Function, Program};

/// What a function does.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Summary {
    /// Bytes of its own on the stack, at most.
    pub(super) frame: u32,
    /// Functions that it calls or goes on in, and where.
    pub(super) calls: Vec<(u32, u32)>,
    /// Where it calls what a register says.
    pub(super) indirect: Vec<u32>,
    /// Addresses that it makes of two halves.
    pub(super) made: BTreeSet<u32>,
    /// What was not understood.
    pub(super) unclear: Vec<String>,
}

/// Reads functions.
pub(super) struct Reader(Capstone);

const SP: u16 = ArmReg::ARM_REG_SP as u16;

impl Reader {
    pub(super) fn new() -> Result<Self> {
        let capstone = Capstone::new()
            .arm()
            .mode(arch::arm::ArchMode::Thumb)
            .extra_mode([arch::arm::ArchExtraMode::MClass].into_iter())
            .detail(true)
            .build()
            .map_err(|error| anyhow!("no disassembler for Thumb: {error}"))?;
        Ok(Self(capstone))
    }

    /// Reads a function of `program`.
    pub(super) fn summary(&self, program: &Program, function: &Function) -> Result<Summary> {
        let mut reading = Reading {
            program,
            function,
            summary: Summary::default(),
            values: BTreeMap::new(),
            tables: BTreeMap::new(),
        };
        let mut aligned = 0;
        for (start, bytes) in program.code(function) {
            let instructions =
                self.0.disasm_all(bytes, u64::from(start)).map_err(|error| anyhow!("{error}"))?;
            let read: usize = instructions.iter().map(capstone::Insn::len).sum();
            if read + 1 < bytes.len() {
                reading.unclear(start + read as u32, "is no instruction");
            }
            for instruction in instructions.iter() {
                let detail = self.0.insn_detail(instruction).map_err(|error| anyhow!("{error}"))?;
                let arch = detail.arch_detail();
                let Some(arm) = arch.arm() else { continue };
                let text = Text {
                    at: instruction.address() as u32,
                    name: unconditional(instruction.mnemonic().unwrap_or_default(), arm),
                    operands: instruction.op_str().unwrap_or_default(),
                };
                reading.flow(&text);
                reading.values(&text, arm);
                aligned += reading.stack(&text, arm, detail.regs_write().iter().any(|reg| reg.0 == SP));
            }
        }
        reading.summary.frame += aligned;
        Ok(reading.summary)
    }
}

/// An instruction as text.
struct Text<'t> {
    at: u32,
    name: &'t str,
    operands: &'t str,
}

impl Text<'_> {
    /// The number of its only or last immediate.
    fn immediate(&self) -> Option<u32> {
        let text = self.operands.rsplit('#').next()?.trim_end_matches([']', '!']);
        let (negative, text) = text.strip_prefix('-').map_or((false, text), |text| (true, text));
        let number = match text.strip_prefix("0x") {
            Some(hex) => u32::from_str_radix(hex, 16).ok()?,
            None => text.parse().ok()?,
        };
        Some(if negative { number.wrapping_neg() } else { number })
    }

    fn first(&self) -> &str {
        self.operands.split(',').next().unwrap_or_default().trim()
    }

    /// Bytes of the registers in its braces.
    fn listed(&self) -> u32 {
        let list = self.operands.rsplit('{').next().unwrap_or_default().trim_end_matches('}');
        let bytes = |register: &str| if register.trim().starts_with('d') { 8 } else { 4 };
        list.split(',').map(bytes).sum()
    }
}

/// A function half read.
struct Reading<'p> {
    program: &'p Program,
    function: &'p Function,
    summary: Summary,
    /// What registers were set to last, in the order of addresses.
    values: BTreeMap<String, u32>,
    /// Registers that point into a table of jumps, and where it starts.
    tables: BTreeMap<String, u32>,
}

impl Reading<'_> {
    fn unclear(&mut self, at: u32, what: &str) {
        self.summary.unclear.push(format!("{}, {at:#x}: {what}", self.function.name));
    }

    fn flow(&mut self, text: &Text<'_>) {
        let Text { at, name, operands } = *text;
        let to_pc = operands.split(',').next() == Some("pc");
        match name {
            "bl" | "blx" | "b" if operands.starts_with('#') => self.jump(text, name == "bl"),
            "blx" => self.summary.indirect.push(at),
            "bx" if operands != "lr" => self.summary.indirect.push(at),
            "mov" if to_pc && self.goes_on_in_table(text) => {}
            "ldr" | "mov" | "add" if to_pc => self.summary.indirect.push(at),
            _ => {}
        }
    }

    /// A jump within the function is none of our business.
    fn jump(&mut self, text: &Text<'_>, call: bool) {
        let Some(target) = text.immediate() else {
            return self.unclear(text.at, "jumps to nowhere");
        };
        if !call && self.function.place.contains(&target) {
            return;
        }
        match self.program.function_around(target) {
            Some(function) => self.summary.calls.push((text.at, function.place.start)),
            None => self.unclear(text.at, "jumps to what is no function"),
        }
    }

    /// A `match` as `addw rN, pc, #TABLE; add rN, rN, rM, lsl #2; mov pc, rN; TABLE: b.w …; b.w …`, with a `nop` where the table
    /// needs one to be aligned: its jumps are read as any others.
    fn goes_on_in_table(&self, text: &Text<'_>) -> bool {
        let register = text.operands.rsplit(',').next().unwrap_or_default().trim();
        self.tables.get(register).is_some_and(|&table| table == (text.at + 5) & !3)
    }

    /// Follows what registers are set to by `mov`, `movw` and `movt`, and to which tables they point.
    fn values(&mut self, text: &Text<'_>, arm: &ArmInsnDetail<'_>) {
        let register = text.first().to_owned();
        let immediate = text.operands.contains('#').then(|| text.immediate()).flatten();
        let operands: Vec<&str> = text.operands.split(',').map(str::trim).collect();
        match (text.name, immediate) {
            ("add" | "addw", Some(offset)) if operands.get(1) == Some(&"pc") => {
                self.values.remove(&register);
                self.tables.insert(register, ((text.at + 4) & !3) + offset);
            }
            ("add", _) if operands.get(1) == Some(&&*register) && operands.get(3) == Some(&"lsl #2") => {
                self.values.remove(&register);
            }
            ("movw" | "mov" | "movs", Some(value)) => {
                self.tables.remove(&register);
                self.values.insert(register, value);
            }
            ("movt", Some(high)) => {
                let value = self.values.get(&register).copied().unwrap_or(0) & 0xFFFF | high << 16;
                self.values.insert(register, value);
                self.summary.made.insert(value);
            }
            _ => {
                let written = arm.operands().any(|operand| {
                    matches!(operand.op_type, ArmOperandType::Reg(_))
                        && operand.access.is_some_and(capstone::AccessType::is_writable)
                });
                if written {
                    self.values.remove(&register);
                    self.tables.remove(&register);
                }
            }
        }
    }

    /// Adds to the frame; what an alignment may take beside it is returned.
    fn stack(&mut self, text: &Text<'_>, arm: &ArmInsnDetail<'_>, implicit: bool) -> u32 {
        // The text tells more than the details: those of `vpush` do not name the pointer.
        let text_says = matches!(text.name, "push" | "pop" | "vpush" | "vpop")
            || text.first() == "sp!"
            || text.operands.contains("[sp")
                && (text.operands.ends_with('!') || text.operands.contains("], #"));
        let mut writes = implicit || text_says;
        for operand in arm.operands() {
            match operand.op_type {
                ArmOperandType::Reg(register) if register.0 == SP => {
                    writes |= operand.access.is_none_or(capstone::AccessType::is_writable);
                }
                ArmOperandType::Mem(memory) if memory.base().0 == SP => writes |= arm.writeback(),
                _ => {}
            }
        }
        let from_sp = text.operands.split(',').nth(1).is_some_and(|from| from.trim() == "sp");
        match text.name {
            // A pointer that is aligned and becomes the stack's.
            "bfc" if text.operands.contains(", #0, #") => {
                return 1_u32.checked_shl(text.immediate().unwrap_or(31)).unwrap_or(u32::MAX) - 1;
            }
            // It may become the stack's as well.
            "sub" | "subw" if !writes && from_sp => {
                self.summary.frame += text.immediate().unwrap_or(0);
                return 0;
            }
            _ if !writes => return 0,
            _ => {}
        }
        let down = match text.name {
            "push" | "vpush" | "vstmdb" => text.listed(),
            "stmdb" if text.first() == "sp!" => text.listed(),
            "str" | "strd" | "strb" | "strh" if text.operands.contains("[sp, #-") => {
                text.immediate().map_or(0, u32::wrapping_neg)
            }
            "sub" | "subw" if text.first() == "sp" => {
                let last = text.operands.rsplit(',').next().unwrap_or_default().trim();
                let value =
                    if last.starts_with('#') { text.immediate() } else { self.values.get(last).copied() };
                let Some(value) = value else {
                    self.unclear(text.at, "takes an unknown number of bytes of the stack");
                    return 0;
                };
                value
            }
            // Up again, or back to where a frame pointer or an aligned copy says, whose way down was counted.
            "pop" | "vpop" | "vldm" | "vldmia" | "ldm" | "ldmia" | "add" | "addw" | "mov" | "ldr"
            | "ldrd" => 0,
            _ => {
                self.unclear(text.at, &format!("{} {}: what it does to the stack", text.name, text.operands));
                0
            }
        };
        self.summary.frame += down;
        0
    }
}

/// The mnemonic without condition and width.
fn unconditional<'m>(name: &'m str, arm: &ArmInsnDetail<'_>) -> &'m str {
    let name = name.split('.').next().unwrap_or_default();
    match arm.cc() {
        ArmCC::ARM_CC_AL | ArmCC::ARM_CC_INVALID => name,
        _ => name.get(..name.len().saturating_sub(2)).unwrap_or(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(code: &[u16]) -> Summary {
        let program = Program::of(&[("f", code), ("g", &[0x4770])], &[]);
        Reader::new().unwrap().summary(&program, program.function_at(0x100).unwrap()).unwrap()
    }

    #[test]
    fn every_way_down_is_counted() {
        let frame = |code: &[u16]| {
            let summary = read(code);
            assert_eq!(summary.unclear, Vec::<String>::new());
            summary.frame
        };
        assert_eq!(frame(&[0x4770]), 0, "bx lr");
        assert_eq!(frame(&[0xB5F0, 0xB084, 0xB004, 0xBDF0]), 20 + 16, "push five, sub sp, add sp, pop");
        assert_eq!(frame(&[0xE92D, 0x4FF0, 0xF5AD, 0x6D80]), 36 + 1024, "push.w nine, sub.w sp");
        assert_eq!(frame(&[0xED2D, 0x8B02]), 8, "vpush of d8");
        assert_eq!(frame(&[0xF84D, 0xBD04]), 4, "str fp, [sp, #-4]!");
        assert_eq!(frame(&[0xF44F, 0x5480, 0xEBAD, 0x0D04]), 4096, "mov.w r4, #4096; sub.w sp, sp, r4");
        // mov r4, sp; bfc r4, #0, #4; mov sp, r4: aligned to 16.
        assert_eq!(frame(&[0xB083, 0x466C, 0xF36F, 0x0403, 0x46A5]), 12 + 15);
        assert_eq!(frame(&[0xB510, 0x2800, 0xBF08, 0xBD10, 0xBD10]), 8, "a conditional pop");
    }

    #[test]
    fn what_takes_an_unknown_number_is_told() {
        let summary = read(&[0xEBAD, 0x0D04]);
        assert!(summary.unclear[0].contains("f, 0x100: takes an unknown number"), "{summary:?}");
    }

    #[test]
    fn calls_and_jumps_out_are_calls() {
        // bl g; b.w g; beq within; bx r3; blx r3
        let code = [0xF000, 0xF806, 0xF000, 0xB804, 0xD0FE, 0x4718, 0x4798, 0xBF00];
        let summary = read(&code);
        assert_eq!(summary.calls, [(0x100, 0x110), (0x104, 0x110)]);
        assert_eq!(summary.indirect, [0x10A, 0x10C]);
    }

    #[test]
    fn a_table_of_jumps_is_no_call_by_address() {
        // addw r6, pc, #8; add.w r6, r6, r2, lsl #2; nop; mov pc, r6; b.w g
        let aligned = [0xF20F, 0x0608, 0xEB06, 0x0682, 0xBF00, 0x46B7, 0xF000, 0xB800];
        let summary = read(&aligned);
        assert_eq!(summary.indirect, [0_u32; 0]);
        assert_eq!(summary.calls, [(0x10C, 0x110)], "the table's jumps are read");
        // The table starts elsewhere; the register was set anew.
        let elsewhere = [0xF20F, 0x060C, 0xEB06, 0x0682, 0xBF00, 0x46B7, 0xF000, 0xB800];
        assert_eq!(read(&elsewhere).indirect, [0x10A]);
        let anew = [0xF20F, 0x0608, 0xEB06, 0x0682, 0x461E, 0x46B7, 0xF000, 0xB800];
        assert_eq!(read(&anew).indirect, [0x10A]);
    }
}
