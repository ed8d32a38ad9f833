#!/usr/bin/env python3
"""Seeds mistakes into the controller's portable part, one at a time, in a copy of the sources,
and runs the tests of fivebar-firmware. Each must be caught.

    firmware/mistakes.py            all of them; the table goes to docs/mistakes.md
    firmware/mistakes.py 3 7        those by number, without writing the table
    firmware/mistakes.py --check    only whether each old text occurs once in its file
"""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "scripts"))
import seeded_mistakes

# What, file, and pairs of old and new text.
MISTAKES = [
    ("a following error holds the arm", "safety/fault.rs", "Self::CommandTimeout | Self::QueueUnderrun =>", "Self::CommandTimeout | Self::QueueUnderrun | Self::FollowingError =>", "            | Self::FollowingError\n", ""),
    ("outside its envelope the arm is held", "safety/fault.rs", "Self::CommandTimeout | Self::QueueUnderrun =>", "Self::CommandTimeout | Self::QueueUnderrun | Self::Envelope =>", "            | Self::Envelope\n", ""),
    ("a silent host switches off", "safety/fault.rs", "Self::CommandTimeout | Self::QueueUnderrun =>", "Self::QueueUnderrun =>", "            | Self::EncoderDisagreement\n", "            | Self::EncoderDisagreement\n            | Self::CommandTimeout\n"),
    ("a queue underrun switches off", "safety/fault.rs", "Self::CommandTimeout | Self::QueueUnderrun =>", "Self::CommandTimeout =>", "            | Self::EncoderDisagreement\n", "            | Self::EncoderDisagreement\n            | Self::QueueUnderrun\n"),
    ("an encoder jump leaves the arm homed", "safety/fault.rs", "Self::EncoderJump | Self::EncoderDisagreement)", "Self::EncoderDisagreement)"),
    ("an encoder disagreement leaves the arm homed", "safety/fault.rs", "Self::EncoderJump | Self::EncoderDisagreement)", "Self::EncoderJump)"),
    ("every fault leaves the arm not homed", "safety/fault.rs", "matches!(self, Self::EncoderJump | Self::EncoderDisagreement)", "true"),
    ("joint 4's jumps unchecked", "safety/monitor.rs", " || Scalar::abs(innovation4) > jump4", " || jump4 < 0.0"),
    ("joint 1's jumps unchecked", "safety/monitor.rs", "Scalar::abs(innovation1) > jump1 ||", "jump1 < 0.0 ||"),
    ("jumps of four times the size pass", "safety/monitor.rs", "protection.over_speed / rate", "4.0 * protection.over_speed / rate"),
    ("joint 4's limits ignored", "safety/monitor.rs", " || Scalar::abs(angle4 - middle4) > reach4", " || angle4 - middle4 > 1e9 * reach4"),
    ("joint 1's limits ignored", "safety/monitor.rs", "Scalar::abs(angle1 - middle1) > reach1", "angle1 - middle1 > 1e9 * reach1"),
    ("only the upper joint limits", "safety/monitor.rs", "Scalar::abs(angle1 - middle1) > reach1 || Scalar::abs(angle4 - middle4) > reach4", "angle1 - middle1 > reach1 || angle4 - middle4 > reach4"),
    ("a whole following error behind a joint limit", "safety/monitor.rs", "let slack = 0.5 *", "let slack = 1.0 *"),
    ("joint 4 unchecked: current, speed and error", "safety/monitor.rs", "Scalar::abs(value1) > limit || Scalar::abs(value4) > limit", "Scalar::abs(value1) > limit || value4 > 1e9 * limit"),
    ("over-current rule of joint 4", "safety/monitor.rs", "either_exceeds(current, self.over_current)", "either_exceeds([current[0]; 2], self.over_current)"),
    ("over-current rule of joint 1", "safety/monitor.rs", "either_exceeds(current, self.over_current)", "either_exceeds([current[1]; 2], self.over_current)"),
    ("over-current limit doubled", "safety/monitor.rs", "over_current: protection.over_current,", "over_current: 2.0 * protection.over_current,"),
    ("over-speed of joint 4 unchecked", "safety/monitor.rs", "either_exceeds(velocity, self.over_speed)", "either_exceeds([velocity[0]; 2], self.over_speed)"),
    ("over-speed limit doubled", "safety/monitor.rs", "over_speed: protection.over_speed,", "over_speed: 2.0 * protection.over_speed,"),
    ("following error of joint 4 unchecked", "safety/monitor.rs", "either_exceeds(error, self.following_error)", "either_exceeds([error[0]; 2], self.following_error)"),
    ("following error doubled", "safety/monitor.rs", "following_error: protection.following_error,", "following_error: 2.0 * protection.following_error,"),
    ("negative values never trip", "safety/monitor.rs", "Scalar::abs(value1) > limit || Scalar::abs(value4) > limit", "value1 > limit || value4 > limit"),
    ("bus limit ten times as high", "safety/monitor.rs", "bus: protection.bus_voltage,", "bus: [protection.bus_voltage[0], 10.0 * protection.bus_voltage[1]],"),
    ("over-voltage unchecked", "safety/monitor.rs", "low <= voltage && voltage <= high", "low <= voltage"),
    ("under-voltage and over-voltage exchanged", "safety/monitor.rs", "} else if voltage < low {", "} else if voltage > high {"),
    ("the singularity monitor never fires", "safety/monitor.rs", "Scalar::abs(links.cross) < self.margin", "Scalar::abs(links.cross) < -self.margin"),
    ("a tenth of the singularity margin", "safety/monitor.rs", "margin: 0.5 * settings", "margin: 0.1 * settings"),
    ("the singularity monitor for one assembly only", "safety/monitor.rs", "Scalar::abs(links.cross) < self.margin", "links.cross < self.margin"),
    ("silence doubled", "safety/monitor.rs", "silence: in_time(protection.command_timeout * rate)", "silence: in_time(2.0 * protection.command_timeout * rate)"),
    ("silence one tick too long", "safety/monitor.rs", "ticks > self.silence", "ticks > self.silence + 1"),
    ("twenty missed ticks tolerated", "safety/monitor.rs", "TOLERATED_TICKS: u32 = 2;", "TOLERATED_TICKS: u32 = 20;"),
    ("a stop while stopped is refused", "safety/state.rs", "Event::Disarm | Event::Stop | Event::Clear) => Some(Self::Stopped)", "Event::Disarm | Event::Clear) => Some(Self::Stopped)", "Event::Homed | Event::Begin | Event::Finish | Event::Rest) => None", "Event::Homed | Event::Begin | Event::Finish | Event::Rest | Event::Stop) => None"),
    ("not-a-number duty of joint 4 unchecked", "controller/tick.rs", "(duty1 + duty4).is_finite()", "(duty1 + 0.0 * f32::from(duty4 > 2.0)).is_finite()"),
    ("not-a-number duty of joint 1 unchecked", "controller/tick.rs", "(duty1 + duty4).is_finite()", "(duty4 + 0.0 * f32::from(duty1 > 2.0)).is_finite()"),
    ("a fault latched without switching off in its tick", "controller/tick.rs", "self.power_off(fault);\n            return self.off();\n        }\n        let torques", "self.power_off(fault);\n            return self.waking();\n        }\n        let torques"),
    ("the brake released when off", "controller/tick.rs", "enable: [false; 2],\n            brake: true,", "enable: [false; 2],\n            brake: false,"),
    ("the brake engaged while driving", "controller/tick.rs", "enable: [true; 2],\n            brake: false,", "enable: [true; 2],\n            brake: true,"),
    ("the brake released while the bridges wake up", "controller/tick.rs", "enable: [true; 2],\n            ..self.off()", "enable: [true; 2],\n            brake: false,\n            ..self.off()"),
    ("loops not reset when off", "controller/tick.rs", "self.waking = self.model.wake_up_ticks;\n        self.release();", "self.waking = self.model.wake_up_ticks;"),
    ("bridges not woken again after they slept", "controller/tick.rs", "self.waking = self.model.wake_up_ticks;\n        self.release();", "self.release();"),
    ("missed ticks not added up", "controller/tick.rs", "self.missed_ticks.wrapping_add(sample.missed_ticks)", "self.missed_ticks.wrapping_add(1)"),
    ("missed ticks only counted", "controller/tick.rs", "sample.missed_ticks > TOLERATED_TICKS && mode.is_powered()", "sample.missed_ticks > 1000 * TOLERATED_TICKS && mode.is_powered()"),
    ("missed ticks a fault with the bridges off", "controller/tick.rs", "sample.missed_ticks > TOLERATED_TICKS && mode.is_powered()", "sample.missed_ticks > TOLERATED_TICKS"),
    ("joint 4's motor never warms", "controller/turns.rs", "if joint.warm(axis) {", "if index == 0 && joint.warm(axis) {"),
    ("joint 1's motor never warms", "controller/turns.rs", "if joint.warm(axis) {", "if index == 1 && joint.warm(axis) {"),
    ("heat at half of its speed", "controller/model.rs", "TURNS as f32 * period,", "0.5 * TURNS as f32 * period,"),
    ("joint 4 with joint 1's constants of heat", "controller/turns.rs", "self.model.axes.get(index))\n        else", "self.model.axes.first())\n        else"),
    ("full duty", "controller/model.rs", "DUTY_LIMIT: f32 = 0.95", "DUTY_LIMIT: f32 = 1.0"),
    ("bridges driven before they are awake", "controller/model.rs", "(WAKE_UP_TIME * control.tick_rate) as u32 + 1", "1"),
    ("a bridge's fault of joint 4 unchecked", "controller/faults.rs", "if driver1 | driver4 {", "if driver1 | (driver1 & driver4) {"),
    ("a bridge judged while it wakes up", "controller/tick.rs", "self.measured_fault(&measurement)", "self.sampled_fault(sample, &measurement)"),
    ("too hot is no fault", "controller/turns.rs", "if joint.warm(axis) {", "if joint.warm(axis) && self.waking > 0 {"),
    ("bus voltage unchecked", "controller/faults.rs", "if let Some(fault) = monitor.bus(self.bus_voltage)", "if let Some(fault) = monitor.bus(self.bus_voltage).filter(|_| self.waking > 0)"),
    ("encoder jump ignored when unpowered", "controller/faults.rs", "let jumped = self.model.monitor.jumped(innovation);", "let jumped = self.is_powered() && self.model.monitor.jumped(innovation);"),
    ("emergency stop ignored when unpowered", "controller/faults.rs", "if sample.emergency_stop {", "if sample.emergency_stop && self.is_powered() {"),
    ("emergency stop ignored while homing", "controller/faults.rs", "if sample.emergency_stop {", "if sample.emergency_stop && self.state != State::Homing {"),
    ("silent host ignored while stopping", "controller/faults.rs", "State::Running | State::Stopping if self.host_timed_out()", "State::Running if self.host_timed_out()"),
    ("silent host a fault while armed", "controller/faults.rs", "monitor.abandoned(self.silence())", "monitor.silent(self.silence())"),
    ("queue underrun ignored", "controller/faults.rs", "State::Running if self.path.runs_short()", "State::Stopped if self.path.runs_short()"),
    ("silence counted from the reset", "controller/faults.rs", "self.ticks.wrapping_sub(self.heard_at)", "self.ticks"),
    ("homing ignores a silent host", "controller/homing.rs", "if self.host_timed_out() {", "if self.host_timed_out() && self.homed {"),
    ("homing leaves the arm homed while it searches", "controller/homing.rs", "self.homed = false;\n        self.homing", "self.homing"),
    ("wrong branch after homing accepted", "controller/homing.rs", "if tool.working_mode(&pose) != self.settings.working_mode() {", "if !u1.x.is_finite() {"),
    ("following error unchecked while homing", "controller/homing.rs", "if self.model.monitor.following_error_exceeded(self.error) {", "if self.homed && self.model.monitor.following_error_exceeded(self.error) {"),
    ("homing's torque of joint 4 unlimited", "controller/homing.rs", "Ok((error, limited(demanded, axis.homing_torque)))", "Ok((error, limited(demanded, if joint.counts() == 0 { 0.0 } else { 100.0 * axis.homing_torque })))"),
    ("homing done with one switch found", "controller/homing.rs", "if let (Some(counts1), Some(counts4)) = (state1.found(), state4.found()) {", "if let (Some(counts1), counts4) = (state1.found(), state4.found().unwrap_or(0)) {"),
    ("switches of the joints exchanged", "controller/homing.rs", "let [closed1, closed4] = sample.home;", "let [closed4, closed1] = sample.home;"),
    ("one sample of a switch believed", "controller/homing_state.rs", "DEBOUNCE_TICKS: u8 = 8;", "DEBOUNCE_TICKS: u8 = 1;"),
    ("counts of the last sample of a switch", "controller/homing_state.rs", "if self.differing == 0 {\n            self.counts", "if self.differing < DEBOUNCE_TICKS {\n            self.counts"),
    ("the search for a switch without end", "controller/homing_state.rs", "gone(from) > config.range", "gone(from) > 10.0 * config.range"),
    ("backing off without end", "controller/homing_state.rs", "closed && gone(from) > 4.0 * config.back_off", "closed && gone(from) > 400.0 * config.back_off"),
    ("no second approach", "controller/homing_state.rs", "self.phase = Phase::BackOff { from: angle };", "self.phase = Phase::Found { counts };"),
    ("creeping at full speed", "controller/homing_state.rs", "0.125 * config.speed", "config.speed"),
    ("observer not settled", "controller/joint.rs", "self.observer = ObserverState::at_rest(self.counted(model));", "self.observer.angle = self.counted(model);"),
    ("the origin's angle not used", "controller/joint.rs", "self.angle_at_origin = angle;", "self.angle_at_origin = 0.0 * angle;"),
    ("counts that do not wrap", "controller/joint.rs", "self.counts.wrapping_sub(self.origin)", "self.counts.saturating_sub(self.origin)"),
    ("clear accepted while the arm moves", "controller/transitions.rs", "self.controlled_stop && !self.path.is_empty()", "self.controlled_stop && self.path.is_empty() && !self.path.is_empty()"),
    ("a controlled stop that does not brake", "controller/transitions.rs", "(State::Fault, _) if self.controlled_stop => self.path.brake(),", "(State::Fault, _) if self.controlled_stop => {}"),
    ("a stop that does not brake", "controller/transitions.rs", "(State::Stopping, _) => self.path.brake(),", "(State::Stopping, _) => {}"),
    ("a stop that drops the path", "controller/transitions.rs", "(State::Stopping, _) => self.path.brake(),", "(State::Stopping, _) => self.forget_path(),"),
    ("a silent host while homing: held", "controller/transitions.rs", "State::Stopped | State::Homing | State::Exciting) => {\n                self.latch_power_off(fault);", "State::Stopped | State::Homing | State::Exciting) => {\n                self.begin_controlled_stop(fault);"),
    ("the last fault is kept", "controller/transitions.rs", "if self.latched.is_none() || self.controlled_stop {", "{"),
    ("a held fault stays when the power goes off", "controller/transitions.rs", "if self.latched.is_none() || self.controlled_stop {", "if self.latched.is_none() {"),
    ("still a controlled stop when the power goes off", "controller/transitions.rs", "            self.controlled_stop = false;\n        }\n        if fault", "        }\n        if fault"),
    ("a cleared fault stays latched", "controller/transitions.rs", "        self.latched = None;\n", ""),
    ("the generation of a dropped path unchanged", "controller/transitions.rs", "self.path_generation = self.path_generation.wrapping_add(1);\n", ""),
    ("arm accepted unhomed", "controller/request.rs", "if !self.homed {", "if !self.homed && self.ticks == 0 {"),
    ("arm accepted outside the limits", "controller/request.rs", "if !within {", "if !within && self.ticks == 0 {"),
    ("joint 4's limits unchecked for arming", "controller/request.rs", ".zip([theta1, theta4])\n            .all", ".zip([theta1])\n            .all"),
    ("arm accepted in a singularity", "controller/request.rs", "if Scalar::abs(pose.sin32()) < settings", "if Scalar::abs(pose.sin32()) < 0.0 * settings"),
    ("angles set while powered", "controller/request.rs", "if self.state != State::Stopped {\n            return Err", "if self.state == State::Running {\n            return Err"),
    ("angles of another branch accepted", "controller/request.rs", "if self.model.tool.working_mode(&pose) != self.settings.working_mode() {", "if !pose.u1.x.is_finite() {"),
    ("an armed arm jumps to the measured position", "controller/request.rs", "if self.state != State::Stopped {\n            return Ok(());", "if self.state == State::Running {\n            return Ok(());"),
    ("an old set-point after arming", "controller/request.rs", "        self.setpoint = Setpoint::hold([pose.u1, pose.u4]);\n", "        let _ = Setpoint::hold([pose.u1, pose.u4]);\n"),
    ("following error against the measured direction", "controller/tracking.rs", "(u1.cross_z(d1), u4.cross_z(d4))", "(u1.cross_z(d1), 0.0 * u4.cross_z(d4))"),
    ("the envelope of the set-point instead of the arm", "controller/tracking.rs", "monitor.outside(self.angles())", "monitor.outside(self.setpoint.direction.map(PlanarVector::polar_angle))"),
    ("parallel links unchecked", "controller/tracking.rs", " || monitor.near_parallel(&links)", ""),
    ("segments of a dropped path accepted", "controller/planning.rs", "follows_paths && path_generation == self.path_generation", "follows_paths"),
    ("paths accepted while stopping", "controller/planning.rs", "State::Armed | State::Running => true,\n            State::Stopped | State::Homing | State::Exciting | State::Stopping |", "State::Armed | State::Running | State::Stopping => true,\n            State::Stopped | State::Homing | State::Exciting |"),
    ("moves accepted while stopping", "planner/mod.rs", "State::Armed | State::Running => true,\n        State::Stopped | State::Homing | State::Exciting | State::Stopping |", "State::Armed | State::Running | State::Stopping => true,\n        State::Stopped | State::Homing | State::Exciting |"),
    ("stops of half the time", "controller/path/brake.rs", "time = time.max(1.5 * speed / acceleration);", "time = time.max(0.1 * speed / acceleration);"),
    ("the planner uses twice the torque", "planner/mod.rs", "TORQUE_SHARE: f32 = 0.8", "TORQUE_SHARE: f32 = 1.6"),
    ("the planner uses half of the margin", "planner/mod.rs", "margin: motion.singularity_margin", "margin: 0.5 * motion.singularity_margin"),
    ("the planner ignores the joint limits", "planner/mod.rs", "limits: JointLimits::new(axis1.angle_limits, axis4.angle_limits).ok()", "limits: JointLimits::new([-7.0, 7.0], [-7.0, 7.0]).ok().filter(|_| axis1.angle_limits != axis4.angle_limits)"),
    ("joint 4 planned with joint 1's limits", "planner/mod.rs", "JointLimits::new(axis1.angle_limits, axis4.angle_limits)", "JointLimits::new(axis1.angle_limits, if axis4.angle_limits[0] > 9.0 { axis4.angle_limits } else { axis1.angle_limits })"),
    ("joints planned at twice their speed", "planner/mod.rs", "axis.max_speed)", "2.0 * axis.max_speed)"),
    ("joints planned at twice their acceleration", "planner/mod.rs", "axis.max_acceleration)", "2.0 * axis.max_acceleration)"),
    ("the tool planned at twice its speed", "planner/mod.rs", "speed: motion.max_speed", "speed: 2.0 * motion.max_speed"),
    ("the tool planned at twice its acceleration", "planner/mod.rs", "acceleration: motion.max_acceleration", "acceleration: 2.0 * motion.max_acceleration"),
    ("the tool planned at four times its jerk", "planner/mod.rs", "jerk: motion.max_jerk", "jerk: 4.0 * motion.max_jerk"),
    ("settings saved while armed", "session/mod.rs", "only_stopped(controller)?;\n            Ok(*controller.settings())", "Ok(*controller.settings())"),
    ("settings applied while armed", "session/mod.rs", "only_stopped(controller)?;\n            *controller", "*controller"),
    ("settings applied unchecked by the board", "session/mod.rs", "checked.map_err(|_| CommandError::Settings)?;", "let _ = checked;"),
    ("default settings saved", "session/mod.rs", "        if !self.has_settings {\n            return Err(CommandError::NoSettings);\n        }\n        board", "        board"),
    ("homing on default settings", "session/mod.rs", "matches!(request, Request::Arm | Request::Home | Request::Excite(_))", "matches!(request, Request::Arm | Request::Excite(_))"),
    ("a repeated command executed again", "session/mod.rs", "SequenceCheck::Next => {", "SequenceCheck::Next | SequenceCheck::Repeat => {", "            SequenceCheck::Repeat => Some(host.reply.clone()),\n", ""),
    ("an early command executed", "session/mod.rs", "SequenceCheck::Next => {", "SequenceCheck::Next | SequenceCheck::Gap => {", "            SequenceCheck::Gap => {\n                let next = CommandError::OutOfSequence(host.last.next());\n                reply(sequence, Reply::Refused(next))\n            }\n", ""),
    ("an emergency stop waits for its number", "session/mod.rs", "let _ = controller.lock(|controller| controller.request(Request::EmergencyStop));", ""),
    ("a tick of the plant as a sign of life", "session/mod.rs", "if !matches!(command, HostCommand::Tick(_)) {", "{"),
    ("a host of another version accepted", "session/mod.rs", "if version != VERSION {", "if version == 0 && version != VERSION {"),
    ("telemetry of the session before goes on", "session/mod.rs", "        self.draft = controller.lock(|controller| *controller.settings());\n        self.sampler = Sampler::off();", "        self.draft = controller.lock(|controller| *controller.settings());"),
    ("a draft of the session before is kept", "session/mod.rs", "        self.draft = controller.lock(|controller| *controller.settings());\n", "        let _ = controller.lock(|controller| *controller.settings());\n"),
    ("checksum unchecked", "protocol/decoder.rs", "if CRC.checksum(checked) != u32::from_le_bytes(*crc) {", "if CRC.checksum(checked) != u32::from_le_bytes(*crc) && checked.is_empty() {"),
    ("frames of the own end accepted", "protocol/decoder.rs", "if sender != M::SENDER as u8 {", "if sender == 0 && sender != M::SENDER as u8 {"),
    ("bytes behind a message accepted", "protocol/decoder.rs", "Ok((message, [])) => Ok(message),", "Ok((message, _)) => Ok(message),"),
    ("settings of another layout accepted", "storage/mod.rs", "pub const LAYOUT: u8 = 3;", "pub const LAYOUT: u8 = 2;"),
    ("a save not read back", "storage/mod.rs", "if self.newest()? == Some((item, half)) {", "if self.newest()? == Some((item, half)) || item.number > 0 {", "Some(found) if found == *item => Ok(())", "Some(_) => Ok(())"),
    ("the half with the newest settings overwritten", "storage/mod.rs", "Some((newest, half)) if half == first => (newest.number.wrapping_add(1), second),", "Some((newest, half)) if half == second => (newest.number.wrapping_add(1), second),"),
    ("damaged settings are no fault at the start", "session/start.rs", "(_, Some(StorageError::Corrupt)) => Some(Fault::SettingsCorrupt),", "(Reset::Watchdog, Some(StorageError::Corrupt)) => Some(Fault::SettingsCorrupt),", "(_, Some(StorageError::Blank |", "(_, Some(StorageError::Corrupt | StorageError::Blank |"),
    ("a watchdog reset is no fault at the start", "session/start.rs", "(Reset::Watchdog, _) => Some(Fault::WatchdogReset),", "(Reset::Watchdog, None) => None,"),
    ("the over-current limit below a motor's peak", "settings/check.rs", "&& protection.over_current >= axis4.peak_current", ""),
    ("the over-speed limit below a joint's speed", "settings/check.rs", "&& protection.over_speed >= axis4.max_speed", ""),
    ("homing faster than joint 4", "settings/check.rs", "&& homing.speed <= axis4.max_speed", ""),
    ("homing at more current than joint 1's peak", "settings/check.rs", "&& homing.current <= axis1.peak_current", ""),
    ("joint 1 unchecked", "settings/check.rs", "for (joint, axis) in [1, 4].into_iter().zip(&self.axes) {", "for (joint, axis) in [1, 4].into_iter().zip(&self.axes).skip(1) {"),
    ("a board's count rate of one joint only", "settings/board.rs", "settings.axes.iter().all(", "settings.axes.iter().take(1).all("),
    ("a fault that holds the arm leaves the tool down in its tick", "controller/tick.rs", "self.take_turn();\n        command.tool = self.path.tool_output();", "command.tool = self.path.tool_output();\n        self.take_turn();"),
    ("the tool not switched off when off", "controller/tick.rs", "        self.release();\n        self.path.switch_tool_off();\n", "        self.release();\n"),
    ("a stop on the path leaves the tool down", "controller/path/mod.rs", "pub(crate) fn brake(&mut self) {\n        self.output.switch_off();", "pub(crate) fn brake(&mut self) {"),
    ("a stop passes segments that switch the tool on", "controller/path/mod.rs", "changes_tool && advance.is_none()", "changes_tool", ".time_scaled(sigma, sigma_dot);\n", ".time_scaled(sigma, sigma_dot);\n            if self.output.is_busy() {\n                self.output.step(segment.tool_output(), 1.0);\n            }\n"),
    ("a dropped path leaves the tool down", "controller/path/mod.rs", "self.drop_committed();\n        self.output.clear();", "self.drop_committed();"),
    ("the tool stays down for a silent host", "controller/tracking.rs", "!self.path.tool_is_off() && self.host_timed_out()", "self.path.tool_is_off() && self.host_timed_out()"),
    ("a power stays on behind the path's end", "controller/path/output.rs", "if !self.stays {", "if self.stays {"),
    ("the tool's output without its delay", "controller/path/output.rs", "self.count.wrapping_sub(self.delay)", "self.count"),
    ("no rest where a servo changes", "planner/mod.rs", "changes && self.tool_output.waits()", "changes && !self.tool_output.waits()"),
    ("the planner takes the tool for down after a stop", "planner/mod.rs", "            self.level = 0;\n", ""),
    ("a servo's times exchanged", "settings/tool_output.rs", "if to > from {", "if to < from {"),
    ("an active low switch as an active high one", "settings/tool_output.rs", "(level > 0) == active_low", "level == 0"),
    ("widths of a servo beyond its frame pass", "settings/tool_output.rs", "<= LONGEST_PULSE", "<= 1e9 * LONGEST_PULSE"),
    ("joint 4's torque limited as joint 1's", "controller/model.rs", "TorqueLimit(settings.peak_torque())", "TorqueLimit([settings.peak_torque()[0]; 2])"),
    ("joint 4's friction by joint 1's constants", "controller/tracking.rs", "torque4 + axis4.friction.torque(omega4d)", "torque4 + axis1.friction.torque(omega4d)"),
    ("joint 4's current loop by joint 1's motor", "controller/tick.rs", "joint4.drive(model4, torque4, &bus)", "joint4.drive(model1, torque4, &bus)"),
    ("joint 4 measured by joint 1's sensors", "controller/tick.rs", "joint4.measure(model4, counts4, current4, alpha4)", "joint4.measure(model1, counts4, current4, alpha4)"),
    ("joint 4's search with joint 1's range", "controller/homing.rs", "state4, config4, closed4", "state4, config1, closed4"),
    ("the margin at C by the length of link 2 alone", "safety/monitor.rs", "singularity_margin * l2 * l3", "singularity_margin * l2 * l2"),
    ("jumps of a reversed gear", "safety/monitor.rs", "TAU / (Scalar::abs(axis.gear_ratio) *", "TAU / (axis.gear_ratio *"),
    ("a reversed gear never rests", "controller/model.rs", "REST_COUNTS * Scalar::abs(radians_per_count)", "REST_COUNTS * radians_per_count"),
    ("the homing torque of a reversed gear", "controller/model.rs", "homing_torque: Scalar::abs(torque_per_current)", "homing_torque: torque_per_current"),
    ("homing at the peak current", "controller/model.rs", "* settings.homing.current", "* axis.peak_current"),
    ("the peak torque of a reversed gear", "settings/arm.rs", "Scalar::abs(axis.gear_ratio) * axis.torque_constant", "axis.gear_ratio * axis.torque_constant"),
    ("an excitation's duty without its limit", "controller/excitation.rs", "limited(value / self.bus_voltage, DUTY_LIMIT)", "value / self.bus_voltage"),
    ("an excitation's travel from joint 1's start", "controller/excitation.rs", "excitation.start = angles;", "excitation.start = [angles[0]; 2];"),
    ("joint 4's zero of the current judged by joint 1's settings", "controller/current_zeros.rs", "self.settings.axes.get(index),\n", "self.settings.axes.first(),\n"),
    ("joint 1's oscillation by the current of one tick", "controller/turns.rs", "0 => self.watch(0, 1),", "0 => self.watch(0, 0),"),
    ("joint 4's oscillation by the current of one tick", "controller/turns.rs", "8 => self.watch(1, 0),", "8 => self.watch(1, 1),"),
    ("oscillation remembered with the bridges off", "controller/joint.rs", "        self.oscillation = Oscillation::NONE;\n", ""),
    ("the current loop's integral kept with the bridges off", "controller/joint.rs", "        self.current_state = CurrentState(0.0);\n        self.integral", "        self.integral"),
    ("a fault that waits outlasts the bridges", "controller/tick.rs", "        self.pending_off = None;\n        self.setpoint.rest();", "        self.setpoint.rest();"),
    ("a stop that waits outlasts the bridges", "controller/tick.rs", "        self.pending_stop = None;\n        self.pending_off = None;", "        self.pending_off = None;"),
    ("a set-point that moves on with the bridges off", "controller/tick.rs", "        self.setpoint.rest();\n        for joint", "        for joint"),
    ("missed ticks leave the tool down in their tick", "controller/tick.rs", "None => self.unpowered(),\n        }\n    }", "None => {}\n        }\n    }"),
    ("missed ticks hide an encoder jump", "controller/tick.rs", "Some(fault) => self.power_off(fault),\n            None => self.unpowered()", "Some(_) => self.unpowered(),\n            None => self.unpowered()"),
    ("a duty that is not a number leaves the tool down in its tick", "controller/tick.rs", "            self.path.switch_tool_off();\n            return None;", "            return None;"),
    ("over-current unjudged while the bridges wake up", "controller/tick.rs", "fault.or_else(|| self.measured_fault(&measurement))", "fault.or(None)"),
    ("joint 4 not settled in Stopped", "controller/transitions.rs", "in self.joints.iter_mut().zip(&self.model.axes) {", "in self.joints.iter_mut().zip(&self.model.axes).take(1) {"),
    ("the planner keeps the limits of older settings", "session/mod.rs", "        *planner = Planner::new(&settings);\n", ""),
    ("the board's parts keep older settings", "session/mod.rs", "        board.use_settings(&settings);\n", ""),
    ("telemetry counts from the older controller's ticks", "session/mod.rs", "        self.sampler.restart_ticks();\n", ""),
    ("a half that cannot be read taken for an empty one", "storage/mod.rs", "return Err(StorageError::Flash),\n                Ok(None)", "continue,\n                Ok(None)"),
    ("an encoder's age ignored", "controller/model.rs", "+ axis.encoder_latency", "+ 0.0 * axis.encoder_latency"),
    ("a silent host looked for in every second turn", "controller/turns.rs", "4 | 12 => self.pending_stop", "4 => self.pending_stop"),
    ("joint 4's encoder table unchecked", "settings/check.rs", ".zip(&self.encoder_tables) {", ".zip(&self.encoder_tables).take(1) {"),
    ("an over-current limit that joint 4's sensor cannot tell", "settings/check.rs", "\n                    && protection.over_current <= axis4.greatest_current()", ""),
    ("an armed arm in the working mode of before", "controller/request.rs", "        self.mode = self.model.tool.working_mode(&pose);\n", ""),
    ("a joint move that leaves the planner in the old working mode", "planner/mod.rs", "self.envelope.workspace.mode = *mode;", "let _ = mode;"),
    ("an arm still homed while it is homed again", "controller/homing.rs", "        self.homed = false;\n        self.homing =", "        self.homing ="),
    ("homing without its limit of torque", "controller/homing.rs", "limited(demanded, axis.homing_torque)", "demanded"),
    ("an encoder's error not counted from the home angle", "controller/homing.rs", "encoder.set_origin(settings.home_angle, encoder.shown_at_home);", "let _ = encoder;"),
    ("an encoder's error counted from home for declared angles", "controller/request.rs", "encoder.set_origin(angle, encoder.shown_at(angle));", "encoder.set_origin(angle, encoder.shown_at_home);"),
    ("a stop keeps the path behind it", "controller/transitions.rs", "(State::Armed, Event::Stop | Event::Rest) => self.forget_path(),", "(State::Armed, Event::Stop | Event::Rest) => self.path.finish(),"),
    ("an abandoned arm powered for ten minutes", "safety/monitor.rs", "DISARM_TIMEOUT: f32 = 60.0", "DISARM_TIMEOUT: f32 = 600.0"),
    ("jumps of forty counts pass", "safety/monitor.rs", "JUMP_COUNTS: f32 = 4.0", "JUMP_COUNTS: f32 = 40.0"),
    ("creeping without end", "controller/homing_state.rs", "gone(from) > 6.0 * config.back_off", "gone(from) > 600.0 * config.back_off"),
    ("excitations of twenty seconds", "controller/excitation.rs", "LONGEST_EXCITATION: f32 = 2.0", "LONGEST_EXCITATION: f32 = 20.0"),
    ("excitations over three turns", "controller/excitation.rs", "FARTHEST_EXCITATION: f32 = 2.0", "FARTHEST_EXCITATION: f32 = 20.0"),
    ("an excited arm at rest while it moves", "controller/excitation.rs", "REST_SPEED: f32 = 0.05", "REST_SPEED: f32 = 0.5"),
    ("zeros of half the converter's range", "controller/current_zeros.rs", "TOLERANCE: f32 = 100.0", "TOLERANCE: f32 = 1000.0"),
    ("zeros measured while the currents vanish", "controller/current_zeros.rs", "SETTLING_TICKS: u32 = 64", "SETTLING_TICKS: u32 = 0"),
    ("viscous and Coulomb friction exchanged", "controller/model.rs", "axis.viscous_friction,\n                axis.coulomb_friction,", "axis.coulomb_friction,\n                axis.viscous_friction,"),
    ("heat by the peak current", "controller/model.rs", "axis.continuous_current,\n                axis.thermal_time_constant,", "axis.peak_current,\n                axis.thermal_time_constant,"),
    ("an excitation on default settings", "session/mod.rs", "matches!(request, Request::Arm | Request::Home | Request::Excite(_))", "matches!(request, Request::Arm | Request::Home)"),
    ("a board's count rate at the planned speed", "settings/board.rs", "settings.protection.over_speed * counts_per_turn", "axis.max_speed * counts_per_turn"),
    ("a board's count rate of a reversed gear", "settings/board.rs", "axis.encoder_counts as f32 * Scalar::abs(axis.gear_ratio)", "axis.encoder_counts as f32 * axis.gear_ratio"),
    ("the counts of a reversed gear unchecked", "settings/check.rs", "let counts = self.encoder_counts as f32 * Scalar::abs(self.gear_ratio);", "let counts = self.encoder_counts as f32 * self.gear_ratio;"),
    ("rotors as seen through half of their gear", "settings/arm.rs", "axis.gear_ratio * axis.gear_ratio * axis.rotor_inertia", "axis.gear_ratio * axis.rotor_inertia"),
    ("a fault's snapshot with the present tick", "controller/report.rs", "tick: latched.tick,", "tick: self.ticks,"),
    ("a fault's snapshot with the present errors", "controller/report.rs", "error: latched.error,", "error: self.error,"),
    ("the demanded current reported as the measured one", "controller/report.rs", "current: self.joints.each_ref().map(|joint| joint.current)", "current: self.joints.each_ref().map(|joint| joint.demand)"),
    ("the state before a fault reported as the fault", "controller/report.rs", "state: latched.state,", "state: self.state,"),
    ("an excitation of an arm that is homed", "controller/excitation.rs", "if self.homed {\n            return Err", "if self.homed && self.ticks == 0 {\n            return Err"),
    ("an end in motion taken for a rest", "planner/supply.rs", "open: ends_in_motion(&segment),", "open: false,"),
    ("the planner ignores the torque", "planner/mod.rs", "torque: Some(TorqueLimits {", "torque: None.or(Some(TorqueLimits {", "torque: settings.peak_torque().map(|torque| TORQUE_SHARE * torque),\n                }),", "torque: settings.peak_torque().map(|torque| 1e6 * TORQUE_SHARE * torque),\n                })),"),
    ("corners cut ten times as far", "planner/mod.rs", "deviation: motion.corner_tolerance", "deviation: 10.0 * motion.corner_tolerance"),
    ("no path beyond the reserve handed over", "planner/mod.rs", "RESERVE + 0.5 * stopping_time(settings)", "RESERVE"),
    ("an old command answered with the last reply", "session/mod.rs", "SequenceCheck::Old => None,", "SequenceCheck::Old => Some(host.reply.clone()),"),
    ("a tool's position reported for an arm that is not homed", "controller/report.rs", "tool: self\n                .homed\n", "tool: self\n                .begun\n"),
    ("a reference reported with the bridges off", "controller/report.rs", "self.is_powered().then(|| self.reference_now())", "self.begun.then(|| self.reference_now())"),
    ("an arm held under a fault not watched for its host's silence", "controller/turns.rs", "} else if self.abandoned() {", "} else if self.abandoned() && self.state == State::Armed {"),
    ("joint 4's motor does not cool with the bridges off", "controller/turns.rs", "            0 => self.warm(0),\n            8 => self.warm(1),", "            0 => self.warm(0),\n            8 => self.warm(0),"),
    ("a timed move may begin with another speed", "planner/timed.rs", ".zip(&begins).zip(STEP);", ".zip(&begins).zip(STEP).take(1);"),
    ("other moves taken while a timed motion goes on", "planner/timed.rs", "self.in_motion = open.then_some(end);", "self.in_motion = None;"),
    ("timed moves with half again the torque", "planner/mod.rs", "limits.torque = self.peak_torque;", "limits.torque = self.peak_torque.map(|torque| 1.5 * torque);"),
    ("a timed motion does not wait for its tool", "planner/timed.rs", "        if rests {\n", "        if rests && snapshot.path_room > 99 {\n"),
    ("a refused timed move ends the wait of a line", "planner/timed.rs", "        if !self.is_empty() ||", "        self.append_waiting()?;\n        if !self.is_empty() ||"),
    ("an approach far beyond the joint's range", "controller/homing_state.rs", "range: high - low + 2.0 * homing.back_off,", "range: high - low + 50.0 * homing.back_off,"),
    ("homing speeds up in a tenth of the time", "controller/homing_state.rs", "acceleration: 10.0 * homing.speed,", "acceleration: 100.0 * homing.speed,"),
    ("joint 1's torque limited without stopping its integral", "controller/tracking.rs", "loop1.integrate(&mut joint1.integral, error1, limited);", "loop1.integrate(&mut joint1.integral, error1, false);"),
    ("a limited torque not reported", "controller/tracking.rs", "limits: limits.with(Limits::TORQUE, limited),", "limits,"),
    ("the first counts taken for a speed", "controller/tick.rs", "            measurement.velocity = [0.0; 2];\n", ""),
    ("limits reported with the bridges off", "controller/tick.rs", "        self.limits = Limits::empty();\n        self.at_rest", "        self.at_rest"),
    ("the duty that is not a number stays in its joint", "controller/tick.rs", "        if !(duty1 + duty4).is_finite() {\n            for joint in &mut self.joints {\n                joint.release();\n            }\n", "        if !(duty1 + duty4).is_finite() {\n"),
    ("the position loop's integral kept with the bridges off", "controller/joint.rs", "        self.integral = Integral(0.0);\n        self.demand", "        self.demand"),
    ("a controlled stop remembered after its fault was cleared", "controller/transitions.rs", "        self.latched = None;\n        self.controlled_stop = false;\n", "        self.latched = None;\n"),
    ("a fault's measured and demanded currents exchanged", "controller/transitions.rs", "            current: joint.current,\n            demand: joint.demand,", "            current: joint.demand,\n            demand: joint.current,"),
    ("a request is no sign of life", "controller/request.rs", "        self.feed_host_timeout();\n", ""),
    ("an excitation goes on with the register of the one before", "controller/excitation.rs", "        self.register = 1;\n        self.end", "        self.end"),
    ("an excitation that begins with the end of the one before", "controller/excitation.rs", "        self.register = 1;\n        self.end = None;\n", "        self.register = 1;\n"),
    ("an excitation's duty that is not a number drives", "controller/excitation.rs", "if joint.duty.is_finite() {", "if joint.duty.is_finite() || joint.duty.is_nan() {"),
    ("settings saved and applied under a fault that holds the arm", "session/mod.rs", "        State::Stopped => Ok(()),\n", "        State::Stopped | State::Fault => Ok(()),\n"),
    ("an implausible zero of a current put to use", "controller/current_zeros.rs", "        if *plausible {\n", "        if *plausible || zero >= 0.0 {\n"),
    ("a second stop begins anew", "controller/path/mod.rs", "        if self.brake.is_none() {\n            let mut time", "        {\n            let mut time"),
]


def path_of(file):
    return f"firmware/src/{file}"


def main():
    seeded_mistakes.check_texts(MISTAKES, path_of)
    copy = ROOT / "target" / "mistakes-firmware"
    seeded_mistakes.copy_sources(copy)
    # The copy has a target folder of its own: in a shared one, cargo takes what was compiled from
    # the copy for what was compiled from here. Random tests need no smallest example.
    environment = {**os.environ, "PROPTEST_MAX_SHRINK_ITERS": "0"}
    environment.pop("CARGO_TARGET_DIR", None)
    # What is quick comes first, because a run ends with the first test program that fails.
    slow = ["planner", "settings"]
    tests = sorted(path.parent.name for path in (ROOT / "firmware/tests").glob("*/main.rs"))
    quick = [name for name in tests if name not in slow]
    groups = [["--lib"]]
    for part in (quick, slow):
        groups.append([word for name in part for word in ("--test", name)])

    def test():
        output = ""
        for group in groups:
            command = ["cargo", "test", "--package", "fivebar-firmware", *group]
            done = seeded_mistakes.run(*command, cwd=copy, env=environment)
            output += done.stdout + done.stderr
            if done.returncode != 0:
                break
        return done.returncode, output

    head = (
        "# Mistakes seeded into the controller\n\n"
        "Mistakes that `firmware/mistakes.py` seeds into the controller's portable part, one at a time, and\n"
        "the tests that caught each. A run ends with the first test program in which one fails, so others\n"
        "may catch it, too.\n\n"
    )
    seeded_mistakes.check(MISTAKES, copy, path_of, test, ROOT / "docs/mistakes.md", head)


if __name__ == "__main__":
    main()
