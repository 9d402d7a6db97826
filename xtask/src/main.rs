//! The project's chores, as `cargo xtask COMMAND`.
//!
//! | module | what lives there |
//! |---|---|
//! | `toolchain` | which compiler can build for Cortex-M here, and what is missing |
//! | `setup` | says how to get what is missing, and gets it when told so |
//! | `boards` | builds the board packages, and finds what they are |
//! | `qemu` | runs an image in QEMU and decodes its messages |
//! | `snapshot` | compares with what was blessed |
//! | `size` | flash and RAM of an image |
//! | `silicon` | checks the images for silicon as files, and flashes them |
//! | `suite` | all images, one after the other |
//! | `stream` | a device in QEMU that streams frames, to be looked at |
//! | `audit` | panics, stack and `unsafe`: nothing hidden |
//! | `board_emu` | images for STM32 on emulated boards |

mod toolchain;
mod setup;
mod boards;
mod qemu;
mod snapshot;
mod size;
mod silicon;
mod suite;
mod stream;
mod audit;
mod board_emu;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "The project's chores")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Say what the images for Cortex-M need and this machine lacks, and how to get it
    Setup(setup::Options),
    /// Build the board packages, in release
    BuildBoards {
        /// Packages of `firmware/boards/`; all of them if none is named
        packages: Vec<String>,
    },
    /// Build the images for silicon and check vectors, map and size
    CheckBoards {
        /// Take the sizes as right
        #[arg(long)]
        bless: bool,
    },
    /// Run a camera in QEMU on a TCP port or a pseudo-terminal, for the inspector
    Stream(stream::Options),
    /// Audit the images: who calls the panic handler, how deep the stack goes; and count `unsafe` in the sources
    Audit(audit::Options),
    /// Flash a board's image and show its log (needs probe-rs)
    Flash {
        /// A package of `firmware/boards/`
        package: String,
    },
    /// Run the images in QEMU and compare with their snapshots
    Qemu(suite::Options),
    /// Run an image for STM32 on an emulated board: the arguments are those of `board-emu`, such as `run ELF --board …`;
    /// without any, build all images and test them there; `show [DIR]`: run the image for the H743 against a trace and show
    /// its pictures in the inspector, or save the first of them
    BoardEmu {
        /// Arguments of `board-emu`
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Run one image in QEMU and show what it says
    Run {
        /// The image, a name in `firmware/boards/mps2/src/bin/`
        image: String,
        /// The machine
        #[arg(long, default_value = "an386")]
        board: qemu::Board,
    },
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Setup(options) => setup::run(&options),
        Command::BuildBoards { packages } => boards::build(&packages).map(|_| true),
        Command::CheckBoards { bless } => silicon::check(bless),
        Command::Stream(options) => stream::run(&options),
        Command::Audit(options) => audit::run(&options),
        Command::Flash { package } => silicon::flash(&package),
        Command::Qemu(options) => suite::run(&options),
        Command::BoardEmu { arguments } if arguments.is_empty() => board_emu::test(),
        Command::BoardEmu { arguments } if arguments[0] == "show" => {
            board_emu::show(arguments.get(1).map(String::as_str))
        }
        Command::BoardEmu { arguments } => board_emu::run(&arguments),
        Command::Run { image, board } => suite::run_one(&image, board),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// The top of the repository.
fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("this package is not at the root").to_path_buf()
}
