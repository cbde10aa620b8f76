
// The plot beside the film: columns over the time or over another column, with a mark at the frame that is shown.
// Columns have the names of pairs and links where these have any; a request may also have their numbers.
const columnNames = ["t", ...film.called], columnNumbers = ["t", ...film.names], columnUnits = ["s", ...film.units];
const lineColours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#808080"];
const plotWidth = 380, plotSides = {left: 62, right: 14, top: 24, bottom: 42}, panelHeight = 120, mostHeight = 330;
let plotMarks = [];

const columnValue = (column, frame) => column == 0 ? film.times[frame] : film.values[frame][column - 1];

// A request as --plot takes it: NAME,NAME:NAME,... Names may hold commas and colons, so the longest one that fits counts.
function curvesOf(text) {
  const curves = [];
  let at = 0, x = 0;
  const skip = () => { while (text[at] == " ") at++; };
  const take = () => {
    skip();
    let found = -1, length = 0;
    for (const names of [columnNames, columnNumbers]) names.forEach((name, i) => {
      if (!text.startsWith(name, at) || !" ,:".includes(text[at + name.length] ?? " ")) return;
      if (name.length > length) [found, length] = [i, name.length];
    });
    if (found < 0) throw new Error("no column is named '" + text.slice(at).split(/[,:]/)[0].trim() + "'");
    at += length;
    skip();
    return found;
  };
  for (;;) {
    let y = take();
    if (text[at] == ":") {
      at++;
      x = y;
      y = take();
    }
    curves.push({x, y});
    if (at >= text.length) return curves;
    if (text[at] != ",") throw new Error("a comma is missing before '" + text.slice(at) + "'");
    at++;
  }
}

// Curves share a panel if their units are the same, over the same column or over columns of one unit.
function panelsOf(curves) {
  const panels = [];
  for (const curve of curves) {
    const mates = panels.find(([first]) => columnUnits[first.y] == columnUnits[curve.y] && (first.x == curve.x
      || (first.x > 0 && curve.x > 0 && columnUnits[first.x] == columnUnits[curve.x])));
    if (mates) mates.push(curve);
    else panels.push([curve]);
  }
  return panels;
}

// The distance of the marks of an axis; angles of a quarter turn or more are marked at parts of a turn.
function markStep(span, unit, most) {
  const power = 10**Math.floor(Math.log10(span/most));
  let steps = [1, 2, 5, 10].map(step => step*power);
  if (unit == "deg" && span > 89.99) steps = [15, 30, 45, 90, 180, 360, 720, 1800, 3600, 7200, 18000, 36000];
  if (unit == "rad" && span > 3.14) steps = [0.25, 0.5, 1, 2, 4, 10, 20, 40, 100, 200].map(step => step*Math.PI);
  return steps.find(step => span/step <= most*1.001) || span;
}

function markText(value, step, unit, span) {
  if (unit != "rad" || span <= 3.14) return String(Number((Math.abs(value) < 1e-6*step ? 0 : value).toPrecision(6)));
  let over = Math.round(4*value/Math.PI), under = 4;
  if (over == 0) return "0";
  for (; under > 1 && over % 2 == 0; under /= 2) over /= 2;
  return (over < 0 ? "-" : "") + (Math.abs(over) == 1 ? "" : Math.abs(over)) + "\u03c0" + (under > 1 ? "/" + under : "");
}

function extentOf(columns) {
  let low = Infinity, high = -Infinity;
  for (const column of columns) {
    for (let frame = 0; frame < frames; frame++) {
      const value = columnValue(column, frame);
      if (!isFinite(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (!(low <= high)) [low, high] = [0, 1];
  if (high - low <= 1e-12*Math.max(Math.abs(low), Math.abs(high))) {
    const half = 0.5*Math.abs(low) || 0.5;
    [low, high] = [low - half, high + half];
  }
  return [low, high];
}

function addTo(parent, tag, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const name in attributes) element.setAttribute(name, attributes[name]);
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}

// One panel from a height downwards: both axes, the curves, and their marks. It returns its height.
function drawPanel(plot, curves, down) {
  const {left, right, top, bottom} = plotSides, width = plotWidth - left - right;
  const xUnit = columnUnits[curves[0].x], yUnit = columnUnits[curves[0].y], overTime = curves[0].x == 0;
  let x = extentOf(curves.map(curve => curve.x)), y = extentOf(curves.map(curve => curve.y)), height = panelHeight;
  if (!overTime && xUnit == yUnit && !/^(deg|rad|rpm)/.test(xUnit)) {
    // a true shape, with a margin around it
    height = Math.max(panelHeight, Math.min(mostHeight, width*(y[1] - y[0])/(x[1] - x[0])));
    const scale = 0.54*Math.max((x[1] - x[0])/width, (y[1] - y[0])/height);
    x = [(x[0] + x[1])/2 - scale*width, (x[0] + x[1])/2 + scale*width];
    y = [(y[0] + y[1])/2 - scale*height, (y[0] + y[1])/2 + scale*height];
  }
  const toX = value => left + width*(value - x[0])/(x[1] - x[0]);
  const toY = value => down + top + height*(y[1] - value)/(y[1] - y[0]);
  const panel = addTo(plot, "g", {}), foot = down + top + height;
  const grid = (ends, unit, most, draw) => {
    const span = ends[1] - ends[0], step = markStep(span, unit, most);
    for (let i = Math.ceil(ends[0]/step - 1e-6); i*step <= ends[1] + 1e-6*step; i++)
      draw(i*step, markText(i*step, step, unit, span));
  };
  grid(y, yUnit, height/24, (value, text) => {
    addTo(panel, "path", {class: "grid", d: "M" + left + " " + toY(value).toFixed(1) + "h" + width});
    addTo(panel, "text", {x: left - 6, y: (toY(value) + 4).toFixed(1), "text-anchor": "end"}, text);
  });
  grid(x, xUnit, 5, (value, text) => {
    addTo(panel, "path", {class: "grid", d: "M" + toX(value).toFixed(1) + " " + foot + "v" + -height});
    addTo(panel, "text", {x: toX(value).toFixed(1), y: foot + 15, "text-anchor": "middle"}, text);
  });
  addTo(panel, "path", {class: "axis", d: "M" + left + " " + (down + top) + "v" + height + "h" + width});
  const withUnit = (name, unit) => unit && unit != "1" ? name + " [" + unit + "]" : name;
  const overOne = curves.every(curve => curve.x == curves[0].x);
  addTo(panel, "text", {x: left + width/2, y: foot + 32, "text-anchor": "middle"},
    withUnit(overOne ? columnNames[curves[0].x] : "", xUnit));
  const head = addTo(panel, "text", {x: left, y: down + 14});
  curves.forEach((curve, i) => {
    const name = overOne ? columnNames[curve.y] : columnNames[curve.x] + ":" + columnNames[curve.y];
    addTo(head, "tspan", {fill: lineColours[i % lineColours.length], class: "head"}, name + " ");
  });
  addTo(head, "tspan", {}, withUnit("", yUnit).trim());
  const now = overTime ? addTo(panel, "path", {class: "now"}) : null;
  curves.forEach((curve, i) => {
    let d = "", pen = "M";
    for (let frame = 0; frame < frames; frame++) {
      const a = columnValue(curve.x, frame), b = columnValue(curve.y, frame);
      if (isFinite(a) && isFinite(b)) d += pen + toX(a).toFixed(1) + " " + toY(b).toFixed(1);
      pen = isFinite(a) && isFinite(b) ? "L" : "M";
    }
    addTo(panel, "path", {class: "line", d, stroke: lineColours[i % lineColours.length]});
    const dot = addTo(panel, "circle", {r: 4, fill: lineColours[i % lineColours.length]});
    plotMarks.push({curve, dot, toX, toY, now: i == 0 ? now : null, top: down + top, height});
  });
  return top + height + bottom;
}

// The plot of the typed columns; a wrong name is told and leaves the plot as it was.
function drawPlot() {
  const plot = $("plot"), note = $("plot-note");
  let panels;
  try {
    panels = panelsOf(curvesOf($("columns").value));
    note.textContent = "";
  } catch (error) {
    note.textContent = $("columns").value.trim() ? error.message : "";
    return;
  }
  plot.replaceChildren();
  plotMarks = [];
  let down = 0;
  for (const curves of panels) down += drawPanel(plot, curves, down);
  plot.setAttribute("viewBox", "0 0 " + plotWidth + " " + down.toFixed(0));
  markPlot(shown);
}

function markPlot(frame) {
  for (const {curve, dot, toX, toY, now, top, height} of plotMarks) {
    const x = toX(columnValue(curve.x, frame)), y = toY(columnValue(curve.y, frame));
    dot.setAttribute("visibility", isFinite(x) && isFinite(y) ? "visible" : "hidden");
    if (isFinite(x) && isFinite(y)) {
      dot.setAttribute("cx", x.toFixed(1));
      dot.setAttribute("cy", y.toFixed(1));
    }
    if (now) now.setAttribute("d", "M" + x.toFixed(1) + " " + top + "v" + height);
  }
}

// The frame at a place of the plot: that of the nearest time, or of the nearest point of a curve.
function frameAt(x, y) {
  let best = Infinity, found = shown;
  for (const {curve, toX, toY, top, height} of plotMarks) {
    if (y < top || y > top + height) continue;
    for (let frame = 0; frame < frames; frame++) {
      const across = toX(columnValue(curve.x, frame)) - x, up = toY(columnValue(curve.y, frame)) - y;
      const far = curve.x == 0 ? Math.abs(across) : Math.hypot(across, up);
      if (far < best) [best, found] = [far, frame];
    }
  }
  return found;
}
