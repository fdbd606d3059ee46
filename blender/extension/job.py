"""Calls that run in the background while the interface stays responsive."""

import threading


class Cancelled(Exception):
    """The user has cancelled the job."""


class Job:
    """Runs `call(progress)` on its own thread. The call must not access Blender's data."""

    def __init__(self, call):
        self.stage, self.share = "", 0.0
        self._cancelled = threading.Event()
        self._call, self._result, self._error = call, None, None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        try:
            self._result = self._call(self._tell)
        # Any error is passed to the caller of `result`.
        except BaseException as error:
            self._error = error

    def _tell(self, stage, share):
        self.stage, self.share = stage, share
        if self._cancelled.is_set():
            raise Cancelled

    @property
    def is_done(self):
        return not self._thread.is_alive()

    def cancel(self):
        """Ends the call when it next reports progress, without waiting for that."""
        self._cancelled.set()

    def result(self):
        """Waits for the call, and returns its result or raises its error."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._result
