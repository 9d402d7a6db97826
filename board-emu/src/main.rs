//! `board-emu`: see the library.

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use anyhow::{Context, Result, anyhow, bail};
use board_emu::board::Kind;
use board_emu::camera::{Camera, Faults};
use board_emu::footage::Footage;
use board_emu::gaps::Allowed;
use board_emu::i2c::{SensorOnI2c, Shared};
use board_emu::run::Plan;
use board_emu::serial::FarEnd;
use clap::{Args, Parser, Subcommand};
use firmware::camif::Bus;
use firmware::sensor::MODELS;
use host_sim::fault::{FaultSpec, Injector};
use host_sim::profile::Profile;
use host_sim::receiver::{Source, parse_bus};
use host_sim::scene::Scene;
use host_sim::sensor::{Mounting, VirtualSensor};
use host_sim::trace::SignalMap;

/// What the exit statuses say.
const STATUSES: &str = "Exit status: 0 the run ended as it should, captured something and met nothing unexpected; \
    1 the image hung, locked up, ended with a failure, never switched the camera interface on, captured nothing, \
    or met a gap that no allow-list expects; 2 bad usage or input";

/// Runs the image that goes to the flash on an emulated STM32 with a camera in front of it.
#[derive(Debug, Parser)]
#[command(version, after_help = STATUSES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run an image against a camera, and say what came of it
    Run(Run),
}

#[derive(Debug, Args)]
#[command(after_help = STATUSES)]
struct Run {
    /// The ELF file
    image: PathBuf,
    /// The board
    #[arg(long)]
    board: Kind,
    /// A trace that the camera's pins play, of any format that host-sim reads
    #[arg(long, value_name = "FILE", required_unless_present = "sensor")]
    trace: Option<PathBuf>,
    /// What the trace's wires mean; without it the one that the trace carries
    #[arg(long, value_name = "NAME|FILE.toml", requires = "trace")]
    profile: Option<String>,
    /// A virtual sensor on I2C1, which the image has to program: ov7670, ov2640, ov5640, mt9v034. Without a trace it drives
    /// the pins as well, as its registers say
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// What the sensor looks at
    #[arg(long, value_name = "NAME", default_value = "demo")]
    scene: String,
    /// Frames that the sensor sends
    #[arg(long, value_name = "N", default_value_t = 4, requires = "sensor", conflicts_with = "trace")]
    frames: u64,
    /// The sensor's input clock, in hertz; its usual one if it is not said
    #[arg(long, value_name = "HZ", requires = "sensor")]
    xclk: Option<u32>,
    /// A fault between camera and pins, as KIND or KIND:key=value,…; `host-sim inject --fault help` lists them
    #[arg(long = "fault", value_name = "KIND[:key=value,…]")]
    faults: Vec<String>,
    /// Pixel clocks that a request waits for the bus, as `host-sim replay` has it: 0..3,stall=40/1000,seed=7
    #[arg(long, value_name = "MIN..MAX,…")]
    bus_latency: Option<String>,
    /// What is not said of a fault is drawn by this seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the serial port goes: `file:PATH`; `tcp:ADDRESS:PORT`, which waits for somebody to connect; `pty`, a
    /// pseudo-terminal, which waits for a reader once its buffer is full
    #[arg(long, value_name = "TO")]
    uart: Option<String>,
    /// Virtual milliseconds that the run may take
    #[arg(long, value_name = "MS", default_value_t = 10_000)]
    deadline: u64,
    /// Millions of instructions that the core retires in a second; fewer make the run faster where the image polls
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2_000))]
    mips: Option<u32>,
    /// A list of gaps of the emulated part that are expected, besides the board's own
    #[arg(long, value_name = "FILE.toml")]
    allow: Option<PathBuf>,
    /// Serve a debugger at this port or address, and wait for it
    #[arg(long, value_name = "[HOST:]PORT", value_parser = address)]
    gdb: Option<SocketAddr>,
    /// Serve the image's RTT terminal (defmt's) at this port or address
    #[arg(long, value_name = "[HOST:]PORT", value_parser = address)]
    rtt: Option<SocketAddr>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse::<u16>() {
        return Ok((Ipv4Addr::LOCALHOST, port).into());
    }
    text.parse().map_err(|_| format!("{text} is neither a port nor an address such as 127.0.0.1:3333"))
}

fn main() -> ExitCode {
    let Command::Run(run) = Arguments::parse().command;
    match run.run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

impl Run {
    fn run(&self) -> Result<bool> {
        let mut allowed = Allowed::of(self.board);
        if let Some(path) = &self.allow {
            allowed.allow.extend(Allowed::read(path)?.allow);
        }
        let (camera, sensor) = self.camera()?;
        let bus = self.bus_latency.as_deref().map(parse_bus).transpose().context("--bus-latency")?;
        let plan = Plan {
            bus: bus.unwrap_or(Bus::IDEAL),
            sensor,
            serial: self.serial()?,
            deadline: self.deadline.saturating_mul(1_000_000),
            mips: self.mips,
            allowed,
            gdb: self.gdb,
            rtt: self.rtt,
            ..Plan::new(self.board, self.image.clone(), camera)
        };
        let report = plan.run(None)?;
        if self.json {
            println!("{}", serde_json::to_string(&report)?);
        } else {
            print!("{report}");
        }
        Ok(report.is_fine())
    }

    /// What drives the pins, and what answers on I2C.
    fn camera(&self) -> Result<(Camera, Option<SensorOnI2c>)> {
        let specs = self
            .faults
            .iter()
            .map(|text| text.parse::<FaultSpec>().map_err(|error| anyhow!("--fault {text}: {error}")));
        let faults = Faults { specs: specs.collect::<Result<_>>()?, seed: self.seed };
        let sensor = self.sensor.as_deref().map(|name| self.sensor(name)).transpose()?;
        let on_i2c = sensor.clone().map(SensorOnI2c);
        let Some(trace) = &self.trace else {
            let Some(sensor) = sensor else { bail!("give --trace FILE or --sensor NAME") };
            let scene = Scene::named(&self.scene, self.seed)?;
            return Ok((Camera::live(sensor, scene, faults, self.frames), on_i2c));
        };
        let profile = self.profile.as_deref().map(Profile::find).transpose()?;
        let source = Source::open(trace, profile.as_ref(), SignalMap::default())?;
        let mut injector = Injector::new(source.profile(), &faults.specs, faults.seed, Footage::default())?;
        source.play(&mut injector, &mut |_| {})?;
        let pclk_hz = source.trace().info().pclk_hz.unwrap_or(source.profile().timing.pclk_hz);
        let pclk_hz = pclk_hz.saturating_mul(injector.clock_factor());
        let footage = injector.finish().unwrap_or_else(|never| match never {});
        Ok((Camera::recorded(footage, pclk_hz), on_i2c))
    }

    fn sensor(&self, name: &str) -> Result<Shared> {
        let model = MODELS.into_iter().find(|model| model.name == name).with_context(|| {
            let names = MODELS.map(|model| model.name).join(", ");
            format!("--sensor {name}: there are {names}")
        })?;
        let input_hz = self.xclk.unwrap_or(model.input_hz);
        let mounting = Mounting { input_hz, wires: 8, monochrome: false };
        let sensor = VirtualSensor::new(model.name, mounting).context("a model without a virtual sensor")?;
        Ok(Arc::new(Mutex::new(sensor)))
    }

    fn serial(&self) -> Result<FarEnd> {
        let Some(to) = &self.uart else { return Ok(FarEnd::memory()) };
        match to.split_once(':') {
            Some(("file", path)) => FarEnd::file(path.as_ref()).with_context(|| path.to_owned()),
            Some(("tcp", address)) => {
                let listener = TcpListener::bind(address).with_context(|| to.clone())?;
                eprintln!("serial port on {}; waiting for somebody to connect", listener.local_addr()?);
                FarEnd::accept(&listener).with_context(|| to.clone())
            }
            None if to == "pty" => {
                let (end, name) = FarEnd::terminal().context("a pseudo-terminal")?;
                eprintln!("serial port on {name}");
                Ok(end)
            }
            _ => bail!("--uart {to}: give file:PATH, tcp:ADDRESS:PORT or pty"),
        }
    }
}
