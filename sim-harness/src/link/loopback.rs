//! A controller in this process behind a stream of bytes, like a board on a serial line.

use super::DesktopDrives;
use super::READ;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, Drives};
use fivebar_firmware::protocol::{Board as Kind, Decoder, HostMessage, Identity, Reset};
use fivebar_firmware::recorder::{Log, Recorder};
use fivebar_firmware::session::Board;
use fivebar_firmware::session::{Session, fault_at_start};
use fivebar_firmware::settings::{CheckedSettings, SettingsError};
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{
    ArmCommand, ArmController, ArmSample, Planner, Settings, Status, ToldSample,
};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::marker::PhantomData;

/// What moves between two ticks of a controller that has its own clock: from the
/// controller's outputs to the next samples of its sensors.
pub type Plant<I = BrushedDrives> = Box<
    dyn FnMut(
            &ArmCommand<<I as DriveInterface>::Command>,
        ) -> ArmSample<<I as DriveInterface>::Sample>
        + Send,
>;

/// Both ends of a connection without faults, and the firmware's session behind it, for drives of any kind. Time
/// passes only while the host waits, so the result does not depend on this machine's speed.
pub struct Loopback<I: DesktopDrives = BrushedDrives> {
    desk: Box<dyn Desk>,
    drives: PhantomData<fn() -> I>,
}

/// A board of a [`Loopback`].
pub trait Desk: Send {
    /// Restarts it with the settings it had; `reset` is the reason.
    ///
    /// # Errors
    /// The first setting that is not valid.
    fn restart(&mut self, reset: Reset) -> Result<(), SettingsError>;

    /// The settings stored last.
    fn saved(&self) -> Option<&Settings>;

    /// The controller's status, of which the session does not know.
    fn status(&self) -> Status;

    /// Bytes on their way to the host. If there are none, the time of one read passes first.
    fn out(&mut self) -> &mut VecDeque<u8>;

    /// Takes bytes of the host.
    fn take(&mut self, bytes: &[u8]);
}

/// A board with these settings, as after a reset.
pub(super) fn desk<I>(
    settings: &Settings,
    plant: Option<Plant<I>>,
) -> Result<Box<dyn Desk>, SettingsError>
where
    I: DriveInterface<Drives: Send> + 'static,
{
    Ok(Box::new(Firmware::<I>::new(settings, plant)?))
}

/// The firmware with its board.
struct Firmware<I: DriveInterface> {
    session: Session,
    controller: ArmController<I::Drives>,
    planner: Planner,
    board: Desktop<I>,
    decoder: Decoder<HostMessage<I::Sample>>,
    /// Bytes on their way to the host.
    out: VecDeque<u8>,
}

/// The board. It stores settings in memory.
struct Desktop<I: DriveInterface> {
    saved: Option<Settings>,
    link: I::Link,
    /// The board's plant and the last outputs; none in lockstep with the host.
    plant: Option<(Plant<I>, ArmCommand<I::Command>)>,
    /// The sample of the last tick, as the host may ask for it.
    sample: ToldSample,
    /// The log at the tick rate.
    log: Box<Log>,
}

impl<I: DriveInterface> Desktop<I> {
    /// One tick of the controller on this sample.
    fn step(
        &mut self,
        controller: &mut ArmController<I::Drives>,
        sample: &ArmSample<I::Sample>,
    ) -> ArmCommand<I::Command> {
        let sensed = I::sense(&mut self.link, sample);
        let told = controller.tick(&sensed);
        let drives = controller.drives();
        self.sample = sensed.with_drives(drives.sensed_words(&sensed.drives));
        let log = self.log.recorder();
        log.record(drives, &sensed, &told, controller.ticks());
        I::command(&mut self.link, &told)
    }
}

impl<I: DriveInterface> Board<I::Drives, I::Sample, I::Command> for Desktop<I> {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        self.saved = Some(*settings);
        Ok(())
    }

    fn use_settings(&mut self, settings: &CheckedSettings) {
        self.link = I::link(settings);
    }

    fn tick(
        &mut self,
        controller: &mut ArmController<I::Drives>,
        sample: &ArmSample<I::Sample>,
    ) -> Option<(ArmCommand<I::Command>, u32)> {
        match self.plant {
            Some(_) => None,
            None => Some((self.step(controller, sample), 0)),
        }
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(self.log.recorder())
    }

    fn sample(&self) -> Option<ToldSample> {
        self.plant.is_some().then_some(self.sample)
    }
}

impl<I: DesktopDrives> Loopback<I> {
    /// A board in lockstep: the host's frames replace its sensors and drives.
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
    pub fn driving(settings: &Settings, plant: Plant<I>) -> Result<Self, SettingsError> {
        Self::new(settings, Some(plant))
    }

    fn new(settings: &Settings, plant: Option<Plant<I>>) -> Result<Self, SettingsError> {
        Ok(Self {
            desk: I::desk(settings, plant)?,
            drives: PhantomData,
        })
    }

    /// Restarts the board with the settings it had; `reset` is the reason.
    ///
    /// # Errors
    /// The first setting that is not valid.
    pub fn restart(&mut self, reset: Reset) -> Result<(), SettingsError> {
        self.desk.restart(reset)
    }

    /// The settings stored last.
    pub fn saved(&self) -> Option<&Settings> {
        self.desk.saved()
    }

    /// The controller's status, of which the session does not know.
    pub fn status(&self) -> Status {
        self.desk.status()
    }
}

impl<I: DesktopDrives> Read for Loopback<I> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let out = self.desk.out();
        if out.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        out.read(bytes)
    }
}

impl<I: DesktopDrives> Write for Loopback<I> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.desk.take(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<I: DriveInterface> Firmware<I> {
    fn new(settings: &Settings, plant: Option<Plant<I>>) -> Result<Self, SettingsError> {
        let settings = settings.check()?;
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        Ok(Self {
            session: Session::new(identity, &settings, true),
            controller: ArmController::new(&settings),
            planner: Planner::new(&settings),
            board: Desktop {
                saved: None,
                link: I::link(&settings),
                plant: plant.map(|plant| (plant, ArmCommand::default())),
                sample: ToldSample::default(),
                log: Box::default(),
            },
            decoder: Decoder::new(),
            out: VecDeque::new(),
        })
    }

    /// Runs the ticks of one read, which lasts [`READ`], on a board with its own clock.
    fn pass_time(&mut self) {
        let Some((mut plant, mut command)) = self.board.plant.take() else {
            return;
        };
        let tick_rate = self.controller.settings().control.tick_rate;
        for _ in 0..(READ.as_secs_f32() * tick_rate).round() as u32 {
            self.planner.run(&mut self.controller);
            let sample = plant(&command);
            command = self.board.step(&mut self.controller, &sample);
        }
        self.board.plant = Some((plant, command));
        self.send_telemetry();
    }

    fn send_telemetry(&mut self) {
        if let Some(frame) = self.session.telemetry(&mut self.controller, &self.planner) {
            self.out.extend(&frame);
        }
    }
}

impl<I: DriveInterface<Drives: Send>> Desk for Firmware<I> {
    fn restart(&mut self, reset: Reset) -> Result<(), SettingsError> {
        let settings = self.controller.settings().check()?;
        let identity = Identity::new(Kind::Desktop, reset);
        self.session = Session::new(identity, &settings, true);
        self.controller = ArmController::new(&settings);
        self.planner = Planner::new(&settings);
        self.board.link = I::link(&settings);
        self.decoder = Decoder::new();
        self.out.clear();
        if let Some(fault) = fault_at_start(true, reset, None) {
            self.controller.latch_fault(fault);
        }
        Ok(())
    }

    fn saved(&self) -> Option<&Settings> {
        self.board.saved.as_ref()
    }

    fn status(&self) -> Status {
        self.controller.status()
    }

    fn out(&mut self) -> &mut VecDeque<u8> {
        if self.out.is_empty() {
            self.pass_time();
        }
        &mut self.out
    }

    fn take(&mut self, bytes: &[u8]) {
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
    }
}
