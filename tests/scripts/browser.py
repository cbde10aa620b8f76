"""A page in a real browser: Chromium without a window, told what to do over two pipes (DevTools protocol)."""
import base64
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

from mech9_cases import PATIENCE

FLAGS = ['--headless', '--remote-debugging-pipe', '--no-first-run', '--disable-gpu', '--disable-dev-shm-usage',
         '--disable-extensions', '--disable-background-networking', '--disable-component-update', '--disable-sync',
         '--force-device-scale-factor=1', '--hide-scrollbars']


def browser_path():
    """The browser of this machine, or None."""
    return shutil.which('chromium') or shutil.which('chromium-browser')


class PageError(Exception):
    """The page failed at what it was asked, or the browser does not answer."""


class Browser:
    """One page in one browser. `errors` collects what its console says, `requests` the addresses that it opens."""

    def __init__(self, width=1000, height=800, patience=10 * PATIENCE):
        self.patience = patience
        self.profile = tempfile.mkdtemp(prefix='browser')
        self.downloads = os.path.join(self.profile, 'downloads')
        self.errors, self.requests, self.number, self.buffer = [], [], 0, b''
        commands, self.commands = os.pipe()
        self.answers, answers = os.pipe()
        words = [browser_path(), *FLAGS, f'--user-data-dir={self.profile}', f'--window-size={width},{height}']
        if os.getuid() == 0:
            words.append('--no-sandbox')   # there is none for root

        def connect():
            # high first: either end may be 3 or 4 itself
            high = os.dup2(commands, 50), os.dup2(answers, 51)
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)
        self.process = subprocess.Popen(words + ['about:blank'], preexec_fn=connect, close_fds=False, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(commands)
        os.close(answers)
        self.session = None
        try:
            self.attach(width, height)
        except PageError:
            self.close()
            raise

    def attach(self, width, height):
        """Take hold of the first page, and listen to it."""
        pages = [one for one in self.call('Target.getTargets')['targetInfos'] if one['type'] == 'page']
        self.session = self.call('Target.attachToTarget', targetId=pages[0]['targetId'], flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.call(domain + '.enable')
        self.resize(width, height)

    def resize(self, width, height, mobile=False, dark=False, still=False):
        """Another window or a telephone; with a dark or a light taste; without motion unless asked for."""
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        self.call('Emulation.setEmulatedMedia', features=[
            {'name': 'prefers-color-scheme', 'value': 'dark' if dark else 'light'},
            {'name': 'prefers-reduced-motion', 'value': 'reduce' if still else 'no-preference'}])

    def receive(self, until):
        """The next message of the browser."""
        while b'\0' not in self.buffer:
            ready, _, _ = select.select([self.answers], [], [], max(0.0, until - time.monotonic()))
            data = os.read(self.answers, 1 << 20) if ready else b''
            if not data:
                raise PageError('the browser does not answer')
            self.buffer += data
        message, _, self.buffer = self.buffer.partition(b'\0')
        return json.loads(message)

    def note(self, message):
        """Keep what the page says by itself."""
        parameters = message.get('params', {})
        if message.get('method') == 'Runtime.exceptionThrown':
            details = parameters['exceptionDetails']
            self.errors.append(details.get('exception', {}).get('description') or details['text'])
        elif message.get('method') == 'Runtime.consoleAPICalled' and parameters['type'] in ('error', 'warning', 'assert'):
            self.errors.append(json.dumps(parameters['args']))
        elif message.get('method') == 'Log.entryAdded' and parameters['entry']['level'] in ('error', 'warning'):
            self.errors.append(parameters['entry']['text'])
        elif message.get('method') == 'Network.requestWillBeSent':
            self.requests.append(parameters['request']['url'])

    def call(self, method, **parameters):
        """Ask for one thing and wait for it."""
        self.number += 1
        message = {'id': self.number, 'method': method, 'params': parameters}
        if self.session:
            message['sessionId'] = self.session
        try:
            os.write(self.commands, json.dumps(message).encode() + b'\0')
        except OSError as error:
            raise PageError(f'the browser is gone: {error}') from error
        until = time.monotonic() + self.patience
        while True:
            answer = self.receive(until)
            if answer.get('id') == self.number:
                if 'error' in answer:
                    raise PageError(f'{method}: {answer["error"]}')
                return answer['result']
            self.note(answer)

    def open(self, path, before=''):
        """Load a file and wait until it is there; `before` is a script that runs first."""
        self.errors, self.requests = [], []
        if before:
            script = self.call('Page.addScriptToEvaluateOnNewDocument', source=before)['identifier']
        self.call('Page.navigate', url='file://' + os.path.abspath(path))
        self.value('new Promise(done => document.readyState == "complete" ? done() : addEventListener("load", done))')
        if before:
            self.call('Page.removeScriptToEvaluateOnNewDocument', identifier=script)

    def value(self, expression):
        """The value of an expression in the page; of a promise, the value that it comes to."""
        result = self.call('Runtime.evaluate', expression=expression, awaitPromise=True, returnByValue=True, userGesture=True)
        if 'exceptionDetails' in result:
            details = result['exceptionDetails']
            raise PageError(f"{expression}: {details.get('exception', {}).get('description') or details['text']}")
        return result['result'].get('value')

    def key(self, key, code=None, modifiers=0):
        """Press and release a key: 'ArrowRight', '+', ' '. Modifiers: 1 Alt, 2 Ctrl, 8 Shift."""
        text = key if len(key) == 1 else ''
        for kind in ('keyDown', 'keyUp'):
            self.call('Input.dispatchKeyEvent', type=kind, key=key, code=code or key, modifiers=modifiers,
                      **({'text': text} if text and kind == 'keyDown' else {}))

    def mouse(self, kind, x, y, **more):
        """mousePressed, mouseMoved, mouseReleased, or mouseWheel with deltaX and deltaY."""
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, **more)

    def touch(self, kind, *points):
        """touchStart, touchMove, touchEnd with the fingers that touch."""
        self.call('Input.dispatchTouchEvent', type=kind, touchPoints=[{'x': x, 'y': y, 'id': i}
                                                                     for i, (x, y) in enumerate(points)])

    def screenshot(self, path):
        """The picture in the window, as PNG."""
        with open(path, 'wb') as file:
            file.write(base64.b64decode(self.call('Page.captureScreenshot', format='png')['data']))

    def close(self):
        """End the browser with all its processes."""
        for pipe in (self.commands, self.answers):
            os.close(pipe)
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            pass
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        shutil.rmtree(self.profile, ignore_errors=True)
