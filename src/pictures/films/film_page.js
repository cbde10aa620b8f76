
const $ = id => document.getElementById(id);
const slider = $("frame"), speed = $("speed"), clock = svg.querySelector("#time");
let playing = false, phase = 0, before = null, waiting = 0;

// A film of less than 3 s is slowed down, and one of more than 15 s is made faster.
const span = Math.abs(film.times[frames - 1] - film.times[0]);
const length = Math.min(15, Math.max(3, span));

function timeText(frame) {
  const time = film.times[frame];
  if (film.decimals < 0) return Number(time.toPrecision(4)) + " s";
  return time.toFixed(film.decimals).replace(/^-(?=[0.]*$)/, "") + " s";
}

function draw(frame) {
  drawScene(frame, false);
  const text = timeText(frame);
  slider.value = frame;
  slider.setAttribute("aria-valuetext", text);
  $("now").textContent = text;
  if (clock) clock.textContent = "t = " + text;
  if ($("values").open) writeValues();
  if ($("curves").open) markPlot(frame);
}

// Time is measured between the frames of the browser, from the first one after a start or a pause, whatever other
// clocks say. After a second without frames, as in a hidden tab, the film goes on where it was.
function tick(now) {
  if (!playing) return;
  if (before !== null) {
    const passed = now - before;
    if (passed > 0 && passed < 1000) phase = (phase + passed/1000/length*speed.value) % 1;
  }
  before = now;
  const frame = Math.min(frames - 1, Math.floor(phase*frames));
  if (frame != shown) draw(frame);
  waiting = requestAnimationFrame(tick);
}

function play(on) {
  playing = on && frames > 1;
  $("play").dataset.playing = playing;
  $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  cancelAnimationFrame(waiting);
  before = null;
  if (playing) waiting = requestAnimationFrame(tick);
}

// The film stops in the middle of the time of a frame, so that rounding leads to no other frame.
function show(frame) {
  play(false);
  phase = (frame + 0.5)/frames;
  draw(frame);
}

const step = by => show((shown + by + frames) % frames);

// The recorded columns with names that hold one of the typed words, up to a number that fits a page.
const most = 60;
let listed = [];

function decimalsOf(column) {
  let largest = 0;
  for (const row of film.values) if (isFinite(row[column])) largest = Math.max(largest, Math.abs(row[column]));
  if (largest == 0) return 0;
  const exponent = Math.floor(Math.log10(largest));
  return exponent < -4 || exponent > 5 ? -1 : 5 - exponent;
}

function listValues() {
  const words = $("filter").value.toLowerCase().split(/[\s,]+/).filter(word => word);
  const wanted = film.names.map((name, column) => column).filter(column =>
    !words.length || words.some(word => (film.called[column] + " " + film.names[column]).toLowerCase().includes(word)));
  listed = wanted.slice(0, most).map(column => {
    const row = document.createElement("div"), [name, value, unit] = ["dt", "dd", "dd"].map(tag =>
      row.appendChild(document.createElement(tag)));
    name.textContent = film.called[column];
    unit.textContent = film.units[column];
    return {row, value, column, decimals: decimalsOf(column)};
  });
  $("list").replaceChildren(...listed.map(one => one.row));
  $("more").textContent = !wanted.length ? "No column has such a name."
    : wanted.length > most ? "and " + (wanted.length - most) + " more: give a part of their names above" : "";
  writeValues();
}

function writeValues() {
  for (const {value, column, decimals} of listed) {
    const number = film.values[shown][column];
    value.textContent = decimals < 0 ? number.toExponential(4) : number.toFixed(decimals);
  }
}

// The picture is saved as it is seen, three times as large, with the style that the page adds to its own.
async function saveImage() {
  const box = svg.viewBox.baseVal, copy = svg.cloneNode(true), image = new Image();
  const canvas = document.createElement("canvas"), link = document.createElement("a");
  copy.append($("picture-style").cloneNode(true));
  copy.setAttribute("width", canvas.width = Math.round(3*box.width));
  copy.setAttribute("height", canvas.height = Math.round(3*box.height));
  image.src = "data:image/svg+xml," + encodeURIComponent(new XMLSerializer().serializeToString(copy));
  await image.decode();
  canvas.getContext("2d").drawImage(image, 0, 0);
  const blob = await new Promise(done => canvas.toBlob(done));
  const title = document.title.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_|_$/g, "").slice(0, 50) || "film";
  link.href = URL.createObjectURL(blob);
  link.download = title + "_" + timeText(shown).replace(" ", "") + ".png";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// One finger or the mouse turns or moves the picture; with shift or the middle button it does the other one of these.
// Two fingers zoom and move.
const pointers = new Map();

function onPage(x, y) {
  return new DOMPoint(x, y).matrixTransform(svg.getScreenCTM().inverse());
}

function drag(x, y, other) {
  if (($("drag").value == "move") != other) move(x, y);
  else turn(x/150, -y/150);
}

function pinch(from, to) {
  const middle = ([a, b]) => ({x: (a.x + b.x)/2, y: (a.y + b.y)/2});
  const apart = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y) || 1;
  const was = middle(from), is = middle(to);
  move(is.x - was.x, is.y - was.y);
  zoomAt(apart(to)/apart(from), is.x, is.y);
}

svg.addEventListener("pointerdown", event => {
  if (event.button > 1) return;
  if (event.button == 1) event.preventDefault();
  pointers.set(event.pointerId, onPage(event.clientX, event.clientY));
  svg.setPointerCapture(event.pointerId);
});
for (const end of ["pointerup", "pointercancel"])
  svg.addEventListener(end, event => pointers.delete(event.pointerId));
svg.addEventListener("pointermove", event => {
  const was = pointers.get(event.pointerId), is = onPage(event.clientX, event.clientY);
  if (!was) return;
  const from = [...pointers.values()];
  pointers.set(event.pointerId, is);
  if (from.length == 1) drag(is.x - was.x, is.y - was.y, event.shiftKey || (event.buttons & 4) > 0);
  if (from.length == 2) pinch(from, [...pointers.values()]);
});
svg.addEventListener("wheel", event => {
  const at = onPage(event.clientX, event.clientY);
  const lines = event.deltaMode == 0 ? event.deltaY/(event.ctrlKey ? 4 : 30) : event.deltaY;
  zoomAt(Math.exp(-0.05*Math.max(-10, Math.min(10, lines))), at.x, at.y);
  event.preventDefault();
}, {passive: false});

const keys = {
  " ": () => play(!playing),
  ArrowRight: () => step(1), ArrowLeft: () => step(-1), Home: () => show(0), End: () => show(frames - 1),
  "+": () => zoomAt(1.25), "=": () => zoomAt(1.25), "-": () => zoomAt(0.8), 0: resetView, s: saveImage
};
const arrows = {ArrowRight: [15, 0], ArrowLeft: [-15, 0], ArrowUp: [0, -15], ArrowDown: [0, 15]};

document.addEventListener("keydown", event => {
  const {target, key} = event, moves = event.shiftKey && arrows[key];
  if (event.ctrlKey || event.altKey || event.metaKey || target.matches("select,input[type=search]")) return;
  if (key == " " && target.matches("button,summary,input[type=checkbox]")) return;
  if (moves) drag(...moves, false);
  else if (keys[key]) keys[key]();
  else return;
  event.preventDefault();
});

slider.max = frames - 1;
slider.addEventListener("input", () => show(Number(slider.value)));
$("play").addEventListener("click", () => play(!playing));
$("back").addEventListener("click", () => step(-1));
$("forward").addEventListener("click", () => step(1));
$("closer").addEventListener("click", () => zoomAt(1.25));
$("farther").addEventListener("click", () => zoomAt(0.8));
$("home").addEventListener("click", resetView);
$("image").addEventListener("click", saveImage);
$("names").addEventListener("change", event => svg.classList.toggle("bare", !event.target.checked));
$("filter").addEventListener("input", listValues);
$("columns").addEventListener("input", drawPlot);
$("curves").addEventListener("toggle", () => markPlot(shown));
for (const kind of ["pointerdown", "pointermove"]) $("plot").addEventListener(kind, event => {
  if (!(event.buttons & 1)) return;
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform($("plot").getScreenCTM().inverse());
  show(frameAt(at.x, at.y));
});
$("values").addEventListener("toggle", writeValues);
addEventListener("resize", drawView);

svg.setAttribute("role", "img");
svg.setAttribute("aria-label", document.title);
$("drag").value = film.planar ? "move" : "turn";
speed.title = "speed 1: " + Number(span.toPrecision(3)) + " s of motion in " + Number(length.toPrecision(3)) + " s";
if (span >= 0.05 && span != length) speed.add(new Option("real time", length/span));
for (const id of ["play", "back", "forward", "frame", "speed"]) $(id).disabled = frames < 2;
$("values").hidden = !film.names.length;
$("values").open = innerWidth > 600;
$("curves").hidden = !film.names.length || frames < 2;
$("curves").open = innerWidth > 600;
$("columns").value = film.plot
  || film.called.filter((_, column) => /^q\d+$/.test(film.names[column])).slice(0, 3).join(",") || film.called[0] || "";
for (const name of columnNames) $("column-names").append(new Option(name));
if (!$("curves").hidden) drawPlot();
listValues();
drawView();
draw(0);
play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
