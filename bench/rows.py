"""The rows of the table: what each side runs, and how their results are compared.

Of several ways to do the same with a peer, the fastest that was found is the one timed. Results are written into arrays
that exist before the clock starts, on both sides.
"""

import cv2
import imagequant
import numpy as np
from PIL import Image

from measure import HEIGHT, WIDTH, Call, Row

REPLICATE = cv2.BORDER_REPLICATE
MATRIX = np.array([[1.7, -0.5, -0.2], [-0.25, 1.5, -0.25], [-0.05, -0.55, 1.6]])
SIGMA = 1.4


def gaussian(gray, made):
    return cv2.GaussianBlur(gray, (5, 5), SIGMA, made, SIGMA, REPLICATE)


class Sobel:
    """Both gradients in one call, then |x| + |y|; NumPy's absolute value is faster than OpenCV's ways to it."""

    def __init__(self, gray):
        self.gray, self.x, self.y, self.made = gray, *(np.empty(gray.shape, np.int16) for _ in range(3))

    def __call__(self):
        cv2.spatialGradient(self.gray, self.x, self.y, 3, REPLICATE)
        np.abs(self.x, out=self.x)
        np.abs(self.y, out=self.y)
        cv2.add(self.x, self.y, self.made)


class Canny:
    def __init__(self, gray):
        self.gray, self.smooth, self.made = gray, np.empty_like(gray), np.empty_like(gray)

    def __call__(self):
        gaussian(self.gray, self.smooth)
        cv2.Canny(self.smooth, 50, 150, self.made, 3, True)


class Unsharp:
    def __init__(self, gray):
        self.gray, self.smooth, self.made = gray, np.empty_like(gray), np.empty_like(gray)

    def __call__(self):
        gaussian(self.gray, self.smooth)
        cv2.addWeighted(self.gray, 2, self.smooth, -1, 0, self.made)


class Simple:
    """One call of OpenCV with an array for its result at the end."""

    def __init__(self, call, source):
        self.call, self.source, self.made = call, source, np.empty_like(source)

    def __call__(self):
        self.call(self.source, self.made)


def gray_world(rgb, made):
    """A sum and a diagonal matrix: faster than cv2.mean, cv2.multiply, tables, or split channels."""
    sums = cv2.sumElems(rgb)[:3]
    gray = sum(sums) / 3
    cv2.transform(rgb, np.diag([gray / sum for sum in sums]), made)


class Fill:
    def __init__(self):
        self.made, self.color = np.zeros((HEIGHT, WIDTH), np.uint8), 0

    def __call__(self):
        self.color ^= 255
        cv2.floodFill(self.made, None, (WIDTH // 2, HEIGHT // 2), self.color)


class Imagequant:
    """libimagequant by its own C functions: the package's own way copies pixels and palette through Python lists."""

    SPEED = 10

    def __init__(self, rgb, colors):
        self.rgba = np.ascontiguousarray(np.dstack([rgb, np.full((HEIGHT, WIDTH), 255, np.uint8)]))
        self.colors, self.indices, self.palette = colors, np.empty((HEIGHT, WIDTH), np.uint8), None

    def __call__(self):
        lib, ffi = imagequant.lib, imagequant.ffi
        attributes = lib.liq_attr_create()
        lib.liq_set_speed(attributes, self.SPEED)
        lib.liq_set_max_colors(attributes, self.colors)
        image = lib.liq_image_create_rgba(attributes, ffi.from_buffer(self.rgba), WIDTH, HEIGHT, 0)
        result = ffi.new("liq_result **")
        if lib.liq_image_quantize(image, attributes, result) != lib.LIQ_OK:
            raise RuntimeError("libimagequant found no palette")
        lib.liq_set_dithering_level(result[0], 0)
        indices = ffi.from_buffer("char[]", self.indices, require_writable=True)
        lib.liq_write_remapped_image(result[0], image, indices, self.indices.size)
        palette = lib.liq_get_palette(result[0])
        self.palette = [(e.r, e.g, e.b) for e in palette.entries[0 : palette.count]]
        lib.liq_result_destroy(result[0])
        lib.liq_image_destroy(image)
        lib.liq_attr_destroy(attributes)

    def picture(self):
        return np.array(self.palette, np.uint8)[self.indices]


class PillowDither:
    """To a palette that ours made before."""

    def __init__(self, rgb, palette):
        self.image, self.palette = Image.fromarray(rgb), Image.new("P", (1, 1))
        self.palette.putpalette(palette.tobytes())

    def __call__(self):
        self.made = self.image.quantize(palette=self.palette, dither=Image.Dither.FLOYDSTEINBERG)

    def picture(self):
        return np.asarray(self.made.convert("RGB"))


def palette_and_picture(written):
    """What our runner writes for indices: the palette's length in 16 bits, the palette, the indices."""
    count = int(written[:2].view(np.uint16)[0])
    palette, indices = written[2 : 2 + 3 * count].reshape(-1, 3), written[2 + 3 * count :]
    return palette, palette[indices].reshape(HEIGHT, WIDTH, 3)


def decibels(one, other):
    return 10 * np.log10(255**2 / np.mean((one.astype(float) - other) ** 2))


def soft(picture):
    """As the eye sees dithering from afar."""
    return cv2.GaussianBlur(picture.astype(np.float32), (0, 0), 2)


def f1(ours, theirs):
    ours, theirs = ours > 0, theirs > 0
    return 2 * np.sum(ours & theirs) / (np.sum(ours) + np.sum(theirs))


def rows(photographs, runner):
    """All rows, in the order of the table."""
    grays, rgbs = ([getattr(p, f"{kind}_path") for p in photographs] for kind in ("gray", "rgb"))

    def filter_row(operation, peer, ours, bar, make, judge, color=False):
        """A row over the photographs. `make` gives the peer's callable with a field `made`."""
        paths = rgbs if color else grays
        peers = [make(p.rgb if color else p.gray) for p in photographs]

        def compare():
            return judge([(runner.made(ours, path), peer()or peer.made) for path, peer in zip(paths, peers)])

        return Row(operation, peer, ours, paths, [Call(p) for p in peers], bar, compare)

    def largest(pairs, kind=np.uint8):
        differences = [np.abs(a.view(kind).astype(int) - b.ravel()) for a, b in pairs]
        most, equal = max(d.max() for d in differences), np.mean([np.mean(d == 0) for d in differences])
        return "equal" if most == 0 else f"differ by at most {most}; {equal:.1%} equal"

    def edges(pairs):
        return f"F1 against it {np.mean([f1(a, b.ravel()) for a, b in pairs]):.4f}"

    yield filter_row("Gaussian 5 × 5 σ 1.4, gray", "OpenCV", "gaussian", 1.0, lambda g: Simple(gaussian, g), largest)
    yield filter_row(
        "Sobel, L1 magnitude", "OpenCV, NumPy", "sobel", 0.5, Sobel, lambda pairs: largest(pairs, np.int16)
    )
    yield filter_row("Gaussian, Canny 50/150 L2", "OpenCV", "canny", 0.8, Canny, edges)
    yield filter_row(
        "median 3 × 3, gray", "OpenCV", "median", 1.5, lambda g: Simple(lambda s, m: cv2.medianBlur(s, 3, m), g), largest
    )
    yield filter_row(
        "bilateral d = 5, gray",
        "OpenCV",
        "bilateral",
        1.0,
        lambda g: Simple(lambda s, m: cv2.bilateralFilter(s, 5, 25, 2, m, REPLICATE), g),
        largest,
    )
    yield filter_row(
        "gray-world balance, RGB", "OpenCV", "gray-world", 0.5, lambda c: Simple(gray_world, c), largest, color=True
    )
    yield filter_row(
        "3 × 3 matrix, RGB",
        "OpenCV",
        "matrix",
        1.0,
        lambda c: Simple(lambda s, m: cv2.transform(s, MATRIX, m), c),
        largest,
        color=True,
    )
    yield filter_row("unsharp mask, gray", "OpenCV", "unsharp", 0.8, Unsharp, largest)
    yield from drawing(runner)
    yield from simplifying(runner)
    yield from palettes(photographs, rgbs, runner)


def drawing(runner):
    def compared(peer, judge):
        return lambda: judge(runner.made(peer))

    def no_picture(operation, peer, ours, theirs, bar, compare):
        return Row(operation, peer, ours, [None], [theirs], bar, compare)

    def same_fill(theirs):
        return "equal" if np.array_equal(runner.made("flood-fill") > 0, theirs.ravel() > 0) else "DIFFERENT"

    fill = Fill()
    name = "flood fill, empty frame"
    imageproc = ("imageproc-flood-fill", None)
    yield no_picture(
        name, "imageproc", "flood-fill", imageproc, 0.5, compared("imageproc-flood-fill", same_fill)
    )

    def fill_by_opencv():
        fill.made[:] = 0
        fill.color = 0
        fill()
        ours = runner.made("flood-fill")
        return "both fill all" if len(set(fill.made.ravel())) == len(set(ours)) == 1 else "DIFFERENT"

    yield no_picture(name, "OpenCV", "flood-fill", Call(fill), None, fill_by_opencv)

    def lines(counts):
        same, ties, other = counts.view(np.uint32)
        words = f"{same:,} lines equal, {ties:,} but for ties"
        return words if other == 0 else f"{words}, {other:,} DIFFERENT"

    for place in ("inside", "over-scanned"):
        theirs = f"clipline-lines-{place}"
        yield no_picture(
            f"10,000 lines {place}", "clipline", f"lines-{place}", (theirs, None), 0.8, compared(theirs, lines)
        )

    def seen():
        counts = [int(runner.made(name).view(np.uint32)[0]) for name in ("clips", "clips-one-by-one", "clipline-clips")]
        return f"{counts[0]:,} seen, of {counts[2]:,} by clipline" if counts[0] == counts[1] else f"DIFFERENT: {counts}"

    for operation, ours in (("100,000 line clips", "clips"), ("100,000 line clips, one by one", "clips-one-by-one")):
        yield no_picture(operation, "clipline", ours, ("clipline-clips", None), 0.5, seen)


def simplifying(runner):
    def points(written):
        return written.view(np.int32).reshape(-1, 2)

    whole = points(runner.made("simplify"))[:10_000].copy()
    name = "Ramer–Douglas–Peucker, 10,000 points, ε = 1"

    def kept(theirs):
        ours = points(runner.made("simplify"))[10_000:]
        same = len({*map(tuple, ours.tolist())} & {*map(tuple, theirs.tolist())})
        return "equal" if np.array_equal(ours, theirs) else f"{len(ours):,} points kept, {len(theirs):,} by it, {same:,} places in both"

    yield Row(
        name,
        "imageproc",
        "simplify",
        [None],
        [("imageproc-simplify", None)],
        0.5,
        lambda: kept(points(runner.made("imageproc-simplify"))[10_000:]),
    )
    curve = whole.reshape(-1, 1, 2)
    approximate = lambda: cv2.approxPolyDP(curve, 1, False)
    yield Row(
        name, "OpenCV", "simplify", [None], [Call(approximate)], None, lambda: kept(approximate().reshape(-1, 2))
    )


def palettes(photographs, paths, runner):
    def mean(pictures):
        return np.mean([decibels(p.rgb, picture) for p, picture in zip(photographs, pictures, strict=True)])

    def by_runner(operation):
        return mean([palette_and_picture(runner.made(operation, path))[1] for path in paths])

    def quality(ours, theirs):
        return lambda: f"{by_runner(ours):.1f} dB against {theirs():.1f}"

    name = "16 colours, fast"
    for peer, theirs in (("quantette, Wu in sRGB", "quantette-wu"), ("quantette, pipeline", "quantette-pipeline")):
        yield Row(
            name,
            peer,
            "quantize-fast",
            paths,
            [(theirs, path) for path in paths],
            0.8,
            quality("quantize-fast", lambda theirs=theirs: by_runner(theirs)),
        )
    for colors in (16, 256):
        peers = [Imagequant(p.rgb, colors) for p in photographs]

        def theirs(peers=peers):
            for peer in peers:
                peer()
            return mean([peer.picture() for peer in peers])

        ours = f"quantize-quality-{colors}"
        yield Row(
            f"{colors} colours, quality", "imagequant, speed 10", ours, paths, [Call(p) for p in peers], 0.5, quality(ours, theirs)
        )
    for colors in (16, 256):
        ours = f"floyd-steinberg-{colors}"
        made = [palette_and_picture(runner.made(ours, path)) for path in paths]
        peers = [PillowDither(p.rgb, palette) for p, (palette, _) in zip(photographs, made, strict=True)]

        def seen_from_afar(peers=peers, made=made):
            for peer in peers:
                peer()
            pairs = zip(photographs, made, peers, strict=True)
            both = [[decibels(soft(p.rgb), soft(m)) for m in (ours, peer.picture())] for p, (_, ours), peer in pairs]
            return "smoothed, {:.1f} dB against {:.1f}".format(*np.mean(both, axis=0))

        yield Row(
            f"Floyd–Steinberg, {colors} colours ready", "Pillow", ours, paths, [Call(p) for p in peers], 0.8, seen_from_afar
        )
