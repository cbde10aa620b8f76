"""The damped driven pendulum x'' + x'/2 + sin x = g cos(2 t/3) of Baker and Gollub, and its variational equation, by Taylor series in
extended precision. The coefficients follow from recurrences: s = sin x and c = cos x have s' = c x', c' = -s x'."""
import numpy as np

ORDER = 26
PERIOD = 3 * np.longdouble('3.14159265358979323846264338327950288')


def _series(t, x, v, force, tangents):
    """Taylor coefficients of x and of the tangents (n, 2) at a time."""
    real = np.longdouble
    drive = real(2) / 3
    a, s, c = (np.zeros(ORDER + 2, real) for _ in range(3))
    w = np.zeros((ORDER + 2, len(tangents)), real)
    a[0], a[1], s[0], c[0] = x, v, np.sin(x), np.cos(x)
    w[0], w[1] = tangents[:, 0], tangents[:, 1]
    # g cos(drive (t + h)) by its derivatives
    driving, phase, factor = [], drive * t, force
    for k in range(ORDER):
        driving.append(factor * (np.cos(phase), -np.sin(phase), -np.cos(phase), np.sin(phase))[k % 4])
        factor = factor * drive / (k + 1)
    for k in range(ORDER):
        if k:
            j = np.arange(1, k + 1)
            s[k] = np.sum(j * a[j] * c[k - j]) / k
            c[k] = -np.sum(j * a[j] * s[k - j]) / k
        a[k + 2] = (driving[k] - s[k] - (k + 1) * a[k + 1] / 2) / ((k + 1) * (k + 2))
        w[k + 2] = (-(c[:k + 1, None] * w[k::-1][:k + 1]).sum(axis=0) - (k + 1) * w[k + 1] / 2) / ((k + 1) * (k + 2))
    return a, w


def _at(coefficients, h):
    """Value and rate of a series."""
    value, rate = coefficients[-1] * 0, coefficients[-1] * 0
    for coefficient in coefficients[::-1]:
        rate = rate * h + value
        value = value * h + coefficient
    return value, rate


def motion(force, x, v, periods, steps=64):
    """Angles and rates after each period, the start included: (periods + 1, 2)."""
    return walk(force, x, v, periods, steps)[0]


def walk(force, x, v, periods, steps=64, tangents=()):
    """Points after each period, and for the tangents (n, 2) the logarithms by which they grow in each period, orthogonalised."""
    real = np.longdouble
    force, x, v = real(force), real(x), real(v)
    tangents = np.array(tangents, real).reshape(-1, 2)
    h = PERIOD / steps
    points, growth = [(x, v)], []
    for period in range(periods):
        for step in range(steps):
            a, w = _series(PERIOD * period + h * step, x, v, force, tangents)
            x, v = _at(a, h)
            tangents = np.stack(_at(w, h), axis=1)
        points.append((x, v))
        logs = []
        for i in range(len(tangents)):
            for j in range(i):
                tangents[i] = tangents[i] - (tangents[i] @ tangents[j]) * tangents[j]
            size = np.sqrt(tangents[i] @ tangents[i])
            tangents[i] = tangents[i] / size
            logs.append(np.log(size))
        growth.append(logs)
    return np.array(points), np.array(growth)
