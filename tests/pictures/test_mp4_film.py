"""Films as MP4 videos, and several films of one run. ffmpeg's own probe counts the frames; a missing or failing ffmpeg is told."""
import json
import os
import stat
import subprocess

import pytest

from mech9_cases import PATIENCE, run
from svg_pictures import example


def animated(program, folder, *paths, path=None, options=()):
    words = [program, example('slider_crank'), '--quiet', '--no-write', '--set', 'time.intervals=20', *options]
    for one in paths:
        words += ['--animate', one]
    env = dict(os.environ, PATH=path) if path else None
    return subprocess.run(words, cwd=folder, env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=120 * PATIENCE)


def test_video(checks, mech9k, tmp_path):
    if not (checks.has('gnuplot', 'gnuplot-nox') and checks.has('ffmpeg', 'ffmpeg')):
        pytest.skip(checks.missing[-1])
    name = '-a: b.MP4'                  # no option, no protocol
    done = animated(mech9k, tmp_path, './' + name)
    checks.equal(done.returncode, 0, f'it is made; {done.stderr}')
    checks.equal(os.listdir(tmp_path), [name], 'and nothing is left behind')
    probe = subprocess.run(['ffprobe', '-v', 'error', '-show_streams', '-of', 'json', 'file:' + name], cwd=tmp_path, text=True,
                           capture_output=True, timeout=60 * PATIENCE, check=True)
    stream, = json.loads(probe.stdout)['streams']
    checks.equal((stream['codec_type'], stream['nb_frames'], stream['pix_fmt']), ('video', '21', 'yuv420p'), 'a frame for each row')
    checks.true(abs(float(stream['duration']) - 3) < 0.2, 'the shortest film takes 3 s', stream['duration'])
    checks.equal((stream['width'] % 2, stream['height'] % 2), (0, 0), 'as players want it')


def test_no_video_without_ffmpeg(checks, mech9k, tmp_path):
    """Without the program, and where it fails."""
    done = animated(mech9k, tmp_path, 'film.mp4', path=str(tmp_path))
    checks.equal(done.returncode, 8, 'no ffmpeg')
    checks.true('made by ffmpeg, which is not here; install ffmpeg (Debian: apt-get install ffmpeg)' in done.stderr
                and 'no moving picture film.mp4' in done.stderr, 'the remedy', done.stderr)
    checks.equal(os.listdir(tmp_path), [], 'no file')
    if not checks.has('gnuplot', 'gnuplot-nox'):
        return
    tools = tmp_path / 'tools'
    tools.mkdir()
    fake = tools / 'ffmpeg'
    fake.write_text('#!/bin/sh\n[ "$1" = -version ] && exit 0\necho "no such encoder" >&2\nexit 3\n', encoding='utf-8')
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    done = animated(mech9k, tmp_path, 'film.mp4', path=f'{tools}:{os.environ["PATH"]}')
    checks.equal(done.returncode, 8, 'ffmpeg fails')
    checks.true('ffmpeg failed: no such encoder' in done.stderr, 'its reason', done.stderr)
    checks.equal(os.listdir(tmp_path), ['tools'], 'the frames are removed')
    done = animated(mech9k, tmp_path, 'no/film.mp4', path=f'{tools}:{os.environ["PATH"]}')
    checks.true(done.returncode == 8 and 'no/film.mp4' in done.stderr, 'no folder', done.stderr)


def test_several_films(checks, mech9k, mech9d, tmp_path):
    done = animated(mech9k, tmp_path, 'a.html', 'b.svg', 'c.html', options=['--sketch', 'd.svg'])
    checks.equal(done.returncode, 0, f'three films; {done.stderr}')
    checks.equal(sorted(os.listdir(tmp_path)), ['a.html', 'b.svg', 'c.html', 'd.svg'], 'all of them, and the sketch')
    checks.true((tmp_path / 'a.html').read_text() == (tmp_path / 'c.html').read_text(), 'of one run')
    told = run(mech9k, example('slider_crank'), '--no-write', '--animate', 'a.html', '--animate', 'b.svg', folder=tmp_path).stderr
    checks.true('animation: a.html\n' in told and 'animation: b.svg\n' in told, 'each is told', told)
    modes = run(mech9d, example('pendulum'), '--quiet', '--modes', '--mode', '1', '--animate', 'e.html', '--animate', 'f.svg',
                folder=tmp_path)
    checks.equal(modes.returncode, 0, f'two films of a mode; {modes.stderr}')
    checks.true((tmp_path / 'e.html').exists() and (tmp_path / 'f.svg').exists(), 'both')
