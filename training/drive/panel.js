// What the operator does and sees beside the picture.

import { View } from "./view.js";

const KEYS = {
  x: ["ArrowRight", "ArrowLeft"], y: ["ArrowUp", "ArrowDown"], z: ["KeyW", "KeyS"],
};
const MORE = [["KeyE", "KeyQ"], ["KeyD", "KeyA"], ["KeyR", "KeyF"], ["KeyT", "KeyG"]];
const NAMES = { ArrowRight: "→", ArrowLeft: "←", ArrowUp: "↑", ArrowDown: "↓" };
const COLOURS = ["#0b62b8", "#d1603d", "#2a8f5c", "#8a4fbd", "#b08b00", "#3a3a3a", "#c2377f"];
const SECONDS = 20, TRAIL = 1500, DEADZONE = 0.12, HEARTBEAT = 150;

const get = id => document.getElementById(id);
const about = await (await fetch("about")).json();
const count = about.outputs.length;
const held = new Set(), dragged = new Array(count).fill(0);
const history = [];
const trails = { load: [], reference: [] };
let frame = null, sent = "", view = null;

async function post(wish) {
  const answer = await fetch("wishes", {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(wish),
  }).catch(() => null);
  if (answer && !answer.ok) get("message").textContent = await answer.text();
}

// Axes: a slider and a pair of keys each.

let spare = 0;
const pairs = about.outputs.map(name => {
  const axis = name.split(".").pop();
  if (about.dimensions === 2 && axis === "z") return KEYS.y;
  return /^[xyz]$/.test(axis) && !name.includes(" ") && name.startsWith(about.outputs[0].split(".")[0])
    ? KEYS[axis] : MORE[spare++ % MORE.length];
});
const sliders = about.outputs.map((name, i) => {
  const row = document.createElement("label");
  row.className = "row";
  const keys = pairs[i].map(key => `<kbd>${NAMES[key] || key.slice(3)}</kbd>`).join(" ");
  row.innerHTML = `<span></span><input type="range" min="-1" max="1" step="any" value="0">
    <output></output><span class="keys">${keys}</span>`;
  row.firstChild.textContent = name;
  if (about.given.includes(name)) row.style.display = "none";  // the sea moves it
  const slider = row.querySelector("input");
  slider.dataset.output = name;
  slider.addEventListener("input", () => { dragged[i] = Number(slider.value); });
  for (const end of ["change", "pointerup", "blur"])
    slider.addEventListener(end, () => { slider.value = 0; dragged[i] = 0; });
  get("axes").append(row);
  return { slider, output: row.querySelector("output") };
});

const typing = event => event.target instanceof HTMLInputElement && event.target.type === "text";
addEventListener("keydown", event => {
  if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.code === "Space") { release(); event.preventDefault(); }
  else if (pairs.flat().includes(event.code)) { held.add(event.code); event.preventDefault(); }
});
addEventListener("keyup", event => held.delete(event.code));
const release = () => { held.clear(); dragged.fill(0); };
addEventListener("blur", release);
document.addEventListener("visibilitychange", release);

function wanted() {
  const pad = [...(navigator.getGamepads?.() || [])].find(Boolean);
  // The left stick is the first two axes, the right one upwards the third.
  const sticks = pad ? [pad.axes[0], -pad.axes[1], -pad.axes[3]] : [];
  const order = about.dimensions === 2 ? [0, 1] : [0, 1, 2];
  const most = Number(get("most").value);
  return about.outputs.map((_, i) => {
    const [plus, minus] = pairs[i];
    const keys = held.has(plus) - held.has(minus);
    const stick = order.includes(i) && Math.abs(sticks[i] || 0) > DEADZONE ? sticks[i] : 0;
    return most * Math.max(-1, Math.min(1, keys + dragged[i] + stick));
  });
}

// While the load is to move, a thread of its own says that the page is still there: what is drawn may
// keep this one busy, and without a word the crane stops.
const heartbeat = new Worker(URL.createObjectURL(new Blob([`
  let url = "";
  onmessage = event => { url = event.data; };
  setInterval(() => { if (url) fetch(url, { method: "POST", body: "{}" }).catch(() => {}); }, ${HEARTBEAT});
`])));
const wishes = new URL("wishes", location.href).href;

function command() {
  const velocity = wanted(), text = JSON.stringify(velocity);
  if (text === sent) return;
  sent = text;
  heartbeat.postMessage(velocity.some(v => v !== 0) ? wishes : "");
  post({ velocity });
}
setInterval(command, 20);

// Switches and what is not known.

for (const box of document.querySelectorAll("[data-wish]"))
  box.addEventListener("change", () => { post({ [box.dataset.wish]: box.checked }); shades(); });
function shades() {
  const on = name => document.querySelector(`[data-wish=${name}]`);
  const both = on("feedforward").checked && on("feedback").checked;
  on("estimate").disabled = !both;
  on("residual").disabled = !both || !about.learned;
  on("residual").parentElement.title = about.learned ? "" : "no policy is shipped for this crane";
  for (const name of ["estimate", "residual"]) on(name).parentElement.classList.toggle("off", on(name).disabled);
}
get("wind").max = about.wind;
[get("load_mass").min, get("load_mass").max] = about.mass;
const said = {
  wind: v => [v, `${v.toFixed(0)} N`],
  wind_direction: v => [v * Math.PI / 180, `${v.toFixed(0)}°`],
  load_mass: v => [v, `${(100 * v).toFixed(0)} %`],
};
for (const [name, say] of Object.entries(said)) {
  const slider = get(name), tell = () => { slider.nextElementSibling.textContent = say(Number(slider.value))[1]; };
  slider.addEventListener("input", () => { tell(); post({ [name]: say(Number(slider.value))[0] }); });
  tell();
}
const most = () => { get("most-out").textContent = `${Number(get("most").value).toFixed(2)} m/s`; };
get("most").addEventListener("input", most);
get("stop").addEventListener("click", () => { release(); post({ velocity: new Array(count).fill(0) }); });
get("begin").addEventListener("click", () => post({ order: "begin" }));
get("record").addEventListener("click", () => post({ order: "record" }));

// Pictures and plots.

function place(values) {
  const named = Object.fromEntries(about.outputs.map((name, i) => [name, values[i]]));
  const part = about.outputs[0].split(".")[0];
  return ["x", "y", "z"].map(axis => named[`${part}.${axis}`] ?? 0);
}

function distance(a, b) {
  const [p, q] = [place(a), place(b)];
  return 1000 * Math.hypot(...p.map((v, i) => v - q[i]));
}

function take(next) {
  if (frame && next.time < frame.time) { history.length = 0; trails.load = []; trails.reference = []; }
  frame = next;
  history.push([next.time, distance(next.load, next.reference), next.tension,
                next.input.map((u, i) => 100 * u / about.limits[i])]);
  while (history.length > 2 && history[0][0] < next.time - SECONDS) history.shift();
  for (const name of ["load", "reference"]) {
    trails[name].push(...place(next[name]));
    if (trails[name].length > 3 * TRAIL) trails[name].splice(0, 3);
  }
  window.driven = { time: next.time, load: next.load, reference: next.reference, frames: (window.driven?.frames || 0) + 1 };
}

function plot(id, pick, names) {
  const canvas = get(id), ratio = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
  const [w, h] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== w * ratio) { canvas.width = w * ratio; canvas.height = h * ratio; }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  const rows = history.map(pick), all = rows.flat();
  let [low, high] = [Math.min(0, ...all), Math.max(0, ...all)];
  if (high - low < 1e-3) high = low + 1e-3;
  const y = v => h - 4 - (h - 8) * (v - low) / (high - low);
  const x = t => 34 + (w - 36) * (1 - (frame.time - t) / SECONDS);
  pen.font = "10px system-ui"; pen.fillStyle = "#5d6b7a"; pen.strokeStyle = "#e3e7eb"; pen.lineWidth = 1;
  for (const v of [low, high]) {
    pen.fillText(Math.abs(v) < 10 ? v.toPrecision(2) : v.toFixed(0), 0, y(v) + (v === high ? 8 : 0));
    pen.beginPath(); pen.moveTo(34, y(v)); pen.lineTo(w, y(v)); pen.stroke();
  }
  let at = 40;
  names.forEach((name, i) => {
    pen.strokeStyle = pen.fillStyle = COLOURS[i % COLOURS.length]; pen.lineWidth = 1.4;
    pen.beginPath();
    rows.forEach((row, k) => pen.lineTo(x(history[k][0]), y(row[i])));
    pen.stroke();
    pen.fillText(name, at, 10);
    at += pen.measureText(name).width + 8;
  });
}

function show() {
  requestAnimationFrame(show);
  if (!frame || frame.shown) return;
  frame.shown = true;
  get("clock").textContent = `${frame.time.toFixed(1)} s${frame.pace < 0.95 ? `, at ${frame.pace} of real time` : ""}`;
  get("error").textContent = `error ${history.at(-1)[1].toFixed(2)} mm`;
  get("message").textContent = frame.message;
  get("record").classList.toggle("on", frame.recording);
  get("record").textContent = frame.recording ? "End recording" : "Record";
  sliders.forEach(({ output }, i) => { output.textContent = `${frame.velocity[i].toFixed(2)} of ${frame.wanted[i].toFixed(2)}`; });
  const lines = get("trail").checked ? [
    { points: trails.reference, colour: [0.05, 0.38, 0.72, 1], size: 3 },
    { points: trails.load, colour: [0.82, 0.3, 0.15, 1], size: 3 },
  ] : [];
  view?.draw(frame.shapes, get("ghost").checked ? frame.ghost : null, lines);
  plot("errors", row => [row[1]], [""]);
  plot("tensions", row => row[2], about.ropes);
  plot("inputs", row => row[3], about.drives);
}

document.title = get("rig").textContent = about.rig.replaceAll("_", " ");
shades(); most();
try { view = new View(get("view"), about); } catch (error) { get("message").textContent = error.message; }
const source = new EventSource("frames");
source.onmessage = event => take(JSON.parse(event.data));
source.onerror = () => { get("message").textContent = "the crane is gone: flatrig drive has ended"; };
requestAnimationFrame(show);
