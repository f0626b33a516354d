"""The command line of lacuna-render, from the settings of a scene. Independent of Blender."""


_PREPARED = ("skelbpt", "spcbpt", "sharebpt")  # methods that need preprocessing


def limits(samples, seconds, error_percent):
    """Options of the limits, of which the first that is reached counts; without any, lacuna-render's defaults apply."""
    options = []
    if samples > 0:
        options += ["--iterations", str(samples)]
    if seconds > 0:
        options += ["--time", "%.9gs" % seconds]
    if error_percent > 0:
        options += ["--until", "mape=%.9g" % (error_percent / 100)]
    return options


def options(settings, frame, threads, transparent=False):
    """The options of a render. `settings`: samples, seconds, error, depth, seed, animate_seed, method. `threads` 0:
    all. `transparent`: the camera does not see the world."""
    found = ["--method", settings.method, *limits(settings.samples, settings.seconds, settings.error),
             "--max-depth", str(settings.depth), "--seed", str(settings.seed + (frame if settings.animate_seed else 0))]
    if settings.method in _PREPARED:
        found.append("--prepare")
    if transparent:
        found.append("--transparent-background")
    if threads:
        found += ["--threads", str(threads)]
    return found


def share_done(settings, seconds, iterations):
    """The progress towards the nearest limit, from 0 to 1."""
    shares = [0.0]
    if settings.seconds > 0:
        shares.append(seconds / settings.seconds)
    if settings.samples > 0:
        shares.append(iterations / settings.samples)
    return min(max(shares), 1.0)
