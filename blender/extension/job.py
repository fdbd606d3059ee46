"""A call that runs beside the interface."""

import threading


class Cancelled(Exception):
    """The user does not want the result any more."""


class Job:
    """Runs `call(progress)` on a thread of its own. It touches nothing of Blender."""

    def __init__(self, call):
        self.stage, self.share = "", 0.0
        self._cancelled = threading.Event()
        self._call, self._result, self._error = call, None, None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        try:
            self._result = self._call(self._tell)
        # Whatever it is, whoever waits gets it.
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
        """The call ends when it next tells its progress; nobody has to wait for that."""
        self._cancelled.set()

    def result(self):
        """What the call gave, or its error."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._result
