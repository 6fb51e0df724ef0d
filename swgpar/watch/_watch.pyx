# distutils: language = c++
"""Signals and the sign of life of watch.hpp."""

cdef extern from "watch.hpp" namespace "swgpar" nogil:
    cdef cppclass Text:
        void set(const char *, int)
    Text before_name
    Text after_name
    Text sign_of_life
    void c_arm "swgpar::arm" (int)
    void c_note_output "swgpar::note_output" ()
    void c_start_heart "swgpar::start_heart" (double)
    void c_stop_heart "swgpar::stop_heart" ()


def arm(int number) -> None:
    """Let a signal end the process with the sentence of `set_sentence`, and exit code 130 (SIGINT) or 143."""
    c_arm(number)


def set_sentence(bytes before not None, bytes after not None) -> None:
    """What is written to stderr, before and after the signal's name; nothing where `after` is empty."""
    before_name.set(before, len(before))
    after_name.set(after, len(after))


def set_sign_of_life(bytes text not None) -> None:
    """What the sign of life says."""
    sign_of_life.set(text, len(text))


def note_output() -> None:
    """Something has been written: the next sign of life is an interval away."""
    c_note_output()


def start_heart(double interval) -> None:
    """Begin to write a sign of life after so many seconds without output. Raises ValueError for none."""
    if not interval > 0.0:
        raise ValueError(f"start_heart: interval is {interval}; expected seconds above 0")
    c_start_heart(interval)


def stop_heart() -> None:
    """End it."""
    with nogil:
        c_stop_heart()
