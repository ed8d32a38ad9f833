"""An arm that is commanded call by call. Its time passes only during the calls, as fast as it is computed."""

import os
import signal
import threading

import pytest

import fivebar

#: One robot of each kind of motors, and two that `fivebar new` makes.
KINDS = ["benchtop", "benchtop_stepper", "leg", "classroom_servo", "mit", "new"]


def connected(robot):
    return fivebar.connect("simulated", robot=robot, real_time=False)


def strokes(live, count):
    """A job of many strokes where the tool is, and its origin."""
    return "G21 G90\nM3\n" + "G1 X4 Y0 F120\nG1 X0 Y0\n" * count, live.state.tool


@pytest.mark.parametrize("robot", KINDS)
def test_every_kind_homes_moves_draws_and_switches_off(robot, robot_of):
    with connected(robot_of(robot)) as live:
        assert (live.state.homed, live.state.tool, live.state.theta) == (False, None, None)
        live.home()
        assert live.state.homed and live.state.fault is None
        live.motors_on()
        assert live.state.state == "Armed"
        x, y = live.state.tool
        live.move_to(x + 2e-3, y, speed=0.02)
        assert live.state.tool == pytest.approx((x + 2e-3, y), abs=1e-3)
        theta = [angle + 5e-3 for angle in live.state.theta]
        live.move_joints(*theta, speed=0.1)
        assert live.state.theta == pytest.approx(theta, abs=1e-2)
        there = tuple(live.arm.forward(live.state.theta, live.arm.assembly).c)
        assert live.state.tool == pytest.approx(there, abs=1e-5)
        job, origin = strokes(live, 1)
        told = []
        assert live.draw(job, origin=origin, progress=lambda *now: told.append(now)) == []
        assert live.state.moves_taken == live.state.moves > 2
        assert all(taken <= moves for taken, moves, _ in told)
        assert live.state.state == "Armed"
        live.motors_off()
        assert live.state.state == "Stopped"
    with pytest.raises(fivebar.ControllerError, match="has ended"):
        live.motors_on()


@pytest.mark.parametrize("robot", KINDS)
def test_a_stop_of_another_thread_ends_a_job_at_rest_and_an_emergency_stop_needs_a_clear(robot, robot_of):
    with connected(robot_of(robot)) as live:
        live.home()
        live.motors_on()
        for stop, error in [(live.stop, fivebar.StoppedError), (live.emergency_stop, fivebar.FaultError)]:
            job, origin = strokes(live, 60)
            moving = threading.Event()

            def stopper():
                moving.wait()
                stop()

            thread = threading.Thread(target=stopper)
            thread.start()
            with pytest.raises(error) as stopped:
                live.draw(job, origin=origin, progress=lambda taken, moves, line: line and moving.set())
            thread.join()
            if error is fivebar.StoppedError:
                assert live.state.state == "Armed" and stopped.value.line > 0
            else:
                assert (stopped.value.number, live.state.fault_number) == (10, 10)
        with pytest.raises(fivebar.FaultError):
            live.draw(job, origin=origin)
        with pytest.raises(fivebar.ControllerError, match="clear it"):
            live.motors_on()


def test_an_error_of_a_watcher_stops_the_arm(arm):
    with connected(arm) as live:
        live.home()
        job, origin = strokes(live, 60)

        def watch(taken, moves, line):
            raise RuntimeError("enough")

        with pytest.raises(RuntimeError, match="enough"):
            live.draw(job, origin=origin, progress=watch)
        assert live.state.state == "Stopped" and live.state.moves_taken < live.state.moves


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs POSIX timers")
def test_ctrl_c_stops_the_arm_on_its_path(arm):
    def interrupt(number, frame):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    with connected(arm) as live:
        live.home()
        live.motors_on()
        job, origin = strokes(live, 400)
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(KeyboardInterrupt):
            live.draw(job, origin=origin)
        assert live.state.state == "Armed"
    signal.signal(signal.SIGALRM, before)


def test_pauses_wait_for_their_user(arm):
    job = "G21 G90\nM3\nG1 X0 Y0 F600\nG1 X5 Y0\nM0\nG1 X0 Y0\n"
    with connected(arm) as live:
        live.home()
        origin = live.state.tool
        with pytest.raises(fivebar.JobError, match="line 5.*on_pause") as refused:
            live.draw(job, origin=origin)
        assert refused.value.line == 5
        seen = []
        live.draw(job, origin=origin, on_pause=lambda text: seen.append((text, live.state.tool)))
        (text, tool), = seen
        assert "5" in text or "M0" in text, text
        assert tool == pytest.approx((origin[0] + 5e-3, origin[1]), abs=2e-4)
        assert live.state.state == "Stopped"


def test_calls_that_cannot_be_done_are_refused_with_the_way_out(arm, tmp_path):
    with connected(arm) as live:
        with pytest.raises(fivebar.ControllerError, match="home first"):
            live.move_to(0.03, 0.2)
        live.home()
        with pytest.raises(fivebar.ControllerError, match="switch them on"):
            live.move_to(0.03, 0.2)
        live.motors_on()
        with pytest.raises(fivebar.JobError) as refused:
            live.move_to(0.9, 0.9)
        assert refused.value.point is not None
        for wrong in (lambda: live.move_to(float("nan"), 0.2), lambda: live.move_to(0.03, 0.2, speed=0.0),
                      lambda: live.move_joints(1.0, 2.0, speed=2.0), lambda: live.draw("G1 X0", scale=-1.0)):
            with pytest.raises(fivebar.FivebarError):
                wrong()
    with pytest.raises(fivebar.ControllerError):
        fivebar.connect("no such port", robot=arm)
    with pytest.raises(fivebar.ControllerError):
        fivebar.connect("emulated", robot=arm, image=tmp_path / "no image")


def test_a_child_of_a_fork_is_refused_and_leaves_the_arm_to_its_parent(arm):
    with connected(arm) as live:
        live.home()
        child = os.fork()
        if child == 0:
            try:
                live.motors_on()
            except fivebar.ControllerError as refused:
                live.close()
                os._exit(0 if "connect in this one" in str(refused) else 1)
            os._exit(2)
        _, status = os.waitpid(child, 0)
        assert os.waitstatus_to_exitcode(status) == 0
        live.motors_on()
        assert live.state.state == "Armed"


def test_a_simulated_arm_keeps_the_machines_time_unless_told_otherwise(arm):
    with fivebar.connect(robot=arm) as live:
        first = live.state.time
        live.home()
        assert live.state.time > first and live.place == "simulated"
        assert "benchtop" in repr(live)
