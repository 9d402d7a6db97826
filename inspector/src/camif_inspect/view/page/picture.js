// A stream's picture: its pixels, what is missing of it, and how it is drawn at any zoom.

const style = getComputedStyle(document.documentElement);
export const colour = (name) => style.getPropertyValue(name).trim();

/** What the picture holds, apart from how it is looked at. */
export class Picture {
  constructor(stream) {
    this.stream = stream;
    this.head = null;
    this.canvas = document.createElement("canvas");
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });
    this.numbers = null;
    this.present = new Uint8Array(0);
    this.stamp = 0;
  }

  take(head) {
    const { width, height, channels } = head;
    const fresh = !this.head || this.head.width !== width || this.head.height !== height || this.head.format !== head.format;
    if (fresh) {
      this.canvas.width = width;
      this.canvas.height = height;
      const Kind = head.bits > 8 ? Uint16Array : Uint8Array;
      this.numbers = new Kind(width * height * channels.length);
    }
    this.head = head;
    this.present = head.present;
    this.stamp++;
    if (!head.rows || !width) return;
    const image = this.context.createImageData(width, head.rows);
    const to = image.data, from = head.pixels, count = width * head.rows;
    if (head.display === 3) {
      for (let i = 0, j = 0, k = 0; i < count; i++, j += 3, k += 4) {
        to[k] = from[j]; to[k + 1] = from[j + 1]; to[k + 2] = from[j + 2]; to[k + 3] = 255;
      }
    } else {
      for (let i = 0, k = 0; i < count; i++, k += 4) {
        to[k] = to[k + 1] = to[k + 2] = from[i]; to[k + 3] = 255;
      }
    }
    // Rows in between that have not come keep the picture before, and are drawn over.
    let start = 0;
    while (start < head.rows) {
      if (!head.closed && !this.present[head.first + start]) { start++; continue; }
      let end = start + 1;
      while (end < head.rows && (head.closed || this.present[head.first + end])) end++;
      this.context.putImageData(image, 0, head.first, 0, start, width, end - start);
      const values = head.numbers ?? head.pixels;
      const row = width * channels.length;
      this.numbers.set(values.subarray(start * row, end * row), (head.first + start) * row);
      start = end;
    }
  }

  /** The numbers of a pixel, or null where none has come. */
  at(x, y) {
    if (!this.head || x < 0 || y < 0 || x >= this.head.width || y >= this.head.height) return null;
    const n = this.head.channels.length, from = (y * this.head.width + x) * n;
    return { values: Array.from(this.numbers.subarray(from, from + n)), missing: !this.present[y] };
  }
}

/** How all pictures are looked at together: the point in the middle, 0 to 1, and screen pixels a pixel; 0 fits. */
export const look = { x: 0.5, y: 0.5, scale: 0, pointer: null, region: null };
export const STEPS = [0.125, 0.25, 0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];

function hatch(context) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = 8;
  const brush = tile.getContext("2d");
  brush.fillStyle = "#2a0827";
  brush.fillRect(0, 0, 8, 8);
  brush.strokeStyle = colour("--missing");
  brush.lineWidth = 1.6;
  for (const x of [-8, 0, 8]) { brush.beginPath(); brush.moveTo(x, 8); brush.lineTo(x + 8, 0); brush.stroke(); }
  return context.createPattern(tile, "repeat");
}

/** A picture on the screen. */
export class View {
  constructor(picture, canvas) {
    this.picture = picture;
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.drawn = "";
  }

  /** Where the picture lies: its corner and scale, in device pixels, on whole ones so that pixels stay exact. */
  place() {
    const { width, height } = this.picture.head;
    const w = this.canvas.width, h = this.canvas.height;
    const ratio = devicePixelRatio || 1;
    let scale = look.scale * ratio;
    if (!scale) {
      scale = Math.min((w - 16 * ratio) / width, (h - 16 * ratio) / height);
      if (scale > 1) scale = Math.floor(scale);
    }
    return { scale, left: Math.round(w / 2 - look.x * width * scale), top: Math.round(h / 2 - look.y * height * scale) };
  }

  pixelAt(event) {
    const box = this.canvas.getBoundingClientRect(), ratio = this.canvas.width / box.width;
    const { scale, left, top } = this.place();
    return [((event.clientX - box.left) * ratio - left) / scale, ((event.clientY - box.top) * ratio - top) / scale];
  }

  draw() {
    const { canvas, context, picture } = this;
    const ratio = devicePixelRatio || 1;
    const w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
    if (!picture.head || !w) return;
    const wanted = JSON.stringify([picture.stamp, look, w, h, document.documentElement.dataset.theme]);
    if (wanted === this.drawn) return;
    this.drawn = wanted;
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    context.clearRect(0, 0, w, h);
    const { head } = picture, { scale, left, top } = this.place();
    context.imageSmoothingEnabled = scale < 1;
    context.imageSmoothingQuality = "high";
    context.drawImage(picture.canvas, left, top, head.width * scale, head.height * scale);
    this.missing(left, top, scale);
    if (scale >= 10) this.grid(left, top, scale, w, h);
    this.marks(left, top, scale);
  }

  /** Lines that are lost get a pattern that is no picture; lines still to come dim the old picture beneath. */
  missing(left, top, scale) {
    const { context, picture: { head, present } } = this;
    const width = head.width * scale;
    context.fillStyle = head.closed ? (this.pattern ??= hatch(context)) : "rgba(8, 9, 10, .62)";
    let last = -1;
    for (let y = 0; y < head.height; y++) {
      if (present[y]) { last = y; continue; }
      let end = y + 1;
      while (end < head.height && !present[end]) end++;
      const from = Math.round(top + y * scale), to = Math.round(top + end * scale);
      // A line may be thinner than a screen pixel, and must be seen all the same.
      context.fillRect(left, from, width, Math.max(1, to - from));
      y = end - 1;
    }
    if (!head.closed && last >= 0) {
      context.fillStyle = colour("--accent");
      context.fillRect(left, Math.round(top + (last + 1) * scale), width, 2);
    }
  }

  grid(left, top, scale, w, h) {
    const { context, picture } = this, { head } = picture;
    const x0 = Math.max(0, Math.floor(-left / scale)), x1 = Math.min(head.width, Math.ceil((w - left) / scale));
    const y0 = Math.max(0, Math.floor(-top / scale)), y1 = Math.min(head.height, Math.ceil((h - top) / scale));
    context.fillStyle = "rgba(128, 128, 128, .28)";
    for (let x = x0; x <= x1; x++) context.fillRect(left + x * scale, top + y0 * scale, 1, (y1 - y0) * scale);
    for (let y = y0; y <= y1; y++) context.fillRect(left + x0 * scale, top + y * scale, (x1 - x0) * scale, 1);
    const lines = head.channels.length, size = Math.min(13, scale / 4.2);
    if (scale < 30 * Math.max(1, lines / 2) || size < 7) return;
    context.font = `${size}px "Plex Mono", monospace`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (let y = y0; y < y1; y++) for (let x = x0; x < x1; x++) {
      const { values, missing } = picture.at(x, y);
      if (missing) continue;
      const light = values.reduce((sum, value) => sum + value, 0) / values.length > 2 ** (head.bits - 1);
      context.fillStyle = light ? "rgba(0, 0, 0, .78)" : "rgba(255, 255, 255, .85)";
      values.forEach((value, i) => {
        context.fillText(value, left + (x + 0.5) * scale, top + (y + 0.5) * scale + (i - (lines - 1) / 2) * size * 1.12);
      });
    }
  }

  /** The chosen region, and the pixel under the pointer in every picture. */
  marks(left, top, scale) {
    const { context, picture: { head } } = this;
    const frame = (x, y, width, height, inside) => {
      const box = [Math.round(left + x * scale) - 0.5, Math.round(top + y * scale) - 0.5, Math.round(width * scale) + 1, Math.round(height * scale) + 1];
      context.lineWidth = 3;
      context.strokeStyle = "rgba(0, 0, 0, .65)";
      context.strokeRect(...box);
      context.lineWidth = 1;
      context.strokeStyle = inside;
      context.strokeRect(...box);
    };
    if (look.region) {
      const { x, y, width, height } = look.region;
      frame(x, y, Math.min(width, head.width - x), Math.min(height, head.height - y), "#fff");
    }
    if (look.pointer && scale >= 3) frame(look.pointer[0], look.pointer[1], 1, 1, colour("--accent"));
    else if (look.pointer) {
      const x = Math.round(left + (look.pointer[0] + 0.5) * scale) + 0.5, y = Math.round(top + (look.pointer[1] + 0.5) * scale) + 0.5;
      context.strokeStyle = "rgba(255, 255, 255, .75)";
      context.lineWidth = 1;
      context.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) { context.moveTo(x + 4 * dx, y + 4 * dy); context.lineTo(x + 12 * dx, y + 12 * dy); }
      context.stroke();
    }
  }
}
