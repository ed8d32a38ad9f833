//! A controller in this process behind a stream of bytes, like a board on a serial line.

use fivebar_firmware::board::Board;
use fivebar_firmware::protocol::{Board as Kind, Decoder, HostMessage, Identity, Reset};
use fivebar_firmware::recorder::{Log, Recorder};
use fivebar_firmware::session::{Session, fault_at_start};
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Controller, Planner, SensorSample, Settings};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};

/// Ticks that pass while a read waits: 10 ms at 10 kHz.
const TICKS_PER_READ: u32 = 100;

/// What moves between two ticks of a controller that has its own clock: from the
/// controller's outputs to the next samples of its sensors.
pub type Plant = Box<dyn FnMut(&ActuatorCommand) -> SensorSample + Send>;

/// Both ends of a connection without faults, and the firmware's session behind it. Time
/// passes only while the host waits, so the result does not depend on this machine's speed.
pub struct Loopback {
    session: Session,
    controller: Controller,
    planner: Planner,
    board: Desktop,
    decoder: Decoder<HostMessage>,
    /// Bytes on their way to the host.
    out: VecDeque<u8>,
}

/// The board. It stores settings in memory.
struct Desktop {
    saved: Option<Settings>,
    /// The board's plant and the last outputs; none in lockstep with the host.
    plant: Option<(Plant, ActuatorCommand)>,
    /// The sample of the last tick.
    sample: SensorSample,
    /// The log at the tick rate.
    log: Box<Log>,
}

impl Board for Desktop {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        self.saved = Some(*settings);
        Ok(())
    }

    fn tick(
        &mut self,
        controller: &mut Controller,
        sample: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        match self.plant {
            Some(_) => None,
            None => {
                let command = controller.tick(sample);
                let log = self.log.recorder();
                log.record(sample, &command, controller.ticks());
                Some((command, 0))
            }
        }
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(self.log.recorder())
    }

    fn sample(&self) -> Option<SensorSample> {
        self.plant.is_some().then_some(self.sample)
    }
}

impl Loopback {
    /// A board in lockstep: the host's frames replace its sensors and bridges.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn lockstep(settings: &Settings) -> Result<Self, SettingsError> {
        Self::new(settings, None)
    }

    /// A board with its own clock that moves `plant`.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn driving(settings: &Settings, plant: Plant) -> Result<Self, SettingsError> {
        Self::new(settings, Some((plant, ActuatorCommand::default())))
    }

    fn new(
        settings: &Settings,
        plant: Option<(Plant, ActuatorCommand)>,
    ) -> Result<Self, SettingsError> {
        let settings = settings.check()?;
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        Ok(Self {
            session: Session::new(identity, &settings, true),
            controller: Controller::new(&settings),
            planner: Planner::new(&settings),
            board: Desktop {
                saved: None,
                plant,
                sample: SensorSample::default(),
                log: Box::default(),
            },
            decoder: Decoder::new(),
            out: VecDeque::new(),
        })
    }

    /// Restarts the board with the settings it had; `reset` is the reason.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn restart(&mut self, reset: Reset) -> Result<(), SettingsError> {
        let settings = self.controller.settings().check()?;
        let identity = Identity::new(Kind::Desktop, reset);
        self.session = Session::new(identity, &settings, true);
        self.controller = Controller::new(&settings);
        self.planner = Planner::new(&settings);
        self.decoder = Decoder::new();
        self.out.clear();
        if let Some(fault) = fault_at_start(true, reset, None) {
            self.controller.latch_fault(fault);
        }
        Ok(())
    }

    /// The settings stored last.
    pub fn saved(&self) -> Option<&Settings> {
        self.board.saved.as_ref()
    }

    /// Runs the ticks of one read on a board with its own clock.
    fn pass_time(&mut self) {
        let Some((plant, command)) = &mut self.board.plant else {
            return;
        };
        for _ in 0..TICKS_PER_READ {
            self.planner.run(&mut self.controller);
            self.board.sample = plant(command);
            *command = self.controller.tick(&self.board.sample);
            let (log, sample) = (self.board.log.recorder(), &self.board.sample);
            log.record(sample, command, self.controller.ticks());
        }
        self.send_telemetry();
    }

    fn send_telemetry(&mut self) {
        if let Some(frame) = self.session.telemetry(&mut self.controller) {
            self.out.extend(&frame);
        }
    }
}

impl Read for Loopback {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.out.is_empty() {
            self.pass_time();
        }
        if self.out.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.out.read(bytes)
    }
}

impl Write for Loopback {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            if let Some(Ok(message)) = self.decoder.feed(byte) {
                let answer = self.session.answer(
                    &message,
                    &mut self.controller,
                    &mut self.planner,
                    &mut self.board,
                );
                self.out.extend(answer.iter().flatten());
                self.send_telemetry();
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
