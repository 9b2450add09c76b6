// Asks for news of the capture, shows the newest, and sends what the buttons mean. Nothing here decides anything.
"use strict";

const $ = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";

function make(name, attributes = {}, text = "") {
  const is_svg = ["path", "g", "text", "circle", "line", "image", "polygon", "title"].includes(name);
  const element = is_svg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

// --- the dial: the front is up, as in every chart of a report ------------------------------------------------------

const RADIUS = 100;

function at(azimuth_deg, share) {
  const a = azimuth_deg * Math.PI / 180;
  return [-RADIUS * share * Math.sin(a), -RADIUS * share * Math.cos(a)];
}

function sector_path(sector, ring) {
  const half = Math.min(sector.width_deg / 2, 179.9);
  const [from, to] = [sector.azimuth_deg - half, sector.azimuth_deg + half];
  const point = (azimuth, share) => at(azimuth, share).map((v) => v.toFixed(2)).join(" ");
  const large = half > 90 ? 1 : 0;
  const [inner, outer] = [ring.inner_share, ring.outer_share].map((share) => (share * RADIUS).toFixed(2));
  return `M${point(from, ring.outer_share)} A${outer} ${outer} 0 ${large} 0 ${point(to, ring.outer_share)} ` +
    `L${point(to, ring.inner_share)} A${inner} ${inner} 0 ${large} 1 ${point(from, ring.inner_share)} Z`;
}

const MARKS = { ok: "✓", redo: "↻", empty: "" };
const WORDS = { ok: "taken", redo: "to redo", empty: "empty" };

function draw_dial(state, next) {
  $("sectors").replaceChildren(...state.sectors.map((sector, index) => {
    const ring = state.rings[sector.ring];
    const is_next = next && next.sector === index;
    const group = make("g", { class: `${sector.state}${is_next ? " next" : ""}` });
    // Near the rim, so that the camera in the middle of a ring does not hide it.
    const [x, y] = at(sector.azimuth_deg, ring.outer_share - 0.08);
    group.append(make("path", { d: sector_path(sector, ring) }), make("text", { x, y, class: "mark" }, MARKS[sector.state]));
    return group;
  }));
  const azimuths = [...new Set(state.sectors.map((s) => s.azimuth_deg))];
  $("names").replaceChildren(...azimuths.filter((_, i) => i % Math.ceil(azimuths.length / 16) === 0).map((azimuth) => {
    const [x, y] = at(azimuth, Math.abs(Math.sin(azimuth * Math.PI / 180)) > 0.3 ? 1.05 : 1.09);
    return make("text", { x, y, class: x > 30 ? "right" : x < -30 ? "left" : "" }, `${Math.round(azimuth)}°`);
  }));
  // The borders of what is done, to redo and next lie above those of their neighbours.
  for (const kind of [".ok", ".redo", ".next"]) $("sectors").append(...$("sectors").querySelectorAll(kind));
  $("ghosts").replaceChildren(...(state.about.is_paired ? state.views : []).map((view) => {
    const [cx, cy] = at(view.azimuth_deg, view.radius_share);
    const group = make("g", { class: view.state });
    group.append(make("circle", { cx, cy, r: 5 }));
    return group;
  }));
  $("ghost-key").hidden = !state.about.is_paired;
  const from = state.frame && state.frame.viewpoint;
  $("camera").toggleAttribute("hidden", !from);
  if (from) {
    const [x, y] = at(from.azimuth_deg, state.frame.radius_share);
    $("body").setAttribute("transform", `translate(${x} ${y}) rotate(${180 - from.azimuth_deg})`);
    const [x1, y1] = at(from.azimuth_deg, Math.max(state.frame.radius_share - 0.1, 0));
    const [x2, y2] = at(from.azimuth_deg, Math.min(0.3, state.frame.radius_share));
    for (const [key, value] of Object.entries({ x1, y1, x2, y2 })) $("sight").setAttribute(key, value);
  }
  const open = state.sectors.filter((s) => s.state !== "ok").map((s) => s.name);
  $("dial-title").textContent = `Views round the model, from above. Open: ${open.join(", ") || "none"}.` +
    (from ? ` The camera is at ${Math.round(from.azimuth_deg)}°.` : "");
}

// --- the preview: the newest frame that has arrived; what has become old meanwhile is never asked for ---------------

let loading = false;
let wanted = null;
let has_image = false;

function show_frame(frame) {
  wanted = frame;
  if (!has_image) note("loading the newest photo");
  if (!loading) load_wanted();
}

function load_wanted() {
  const frame = wanted;
  wanted = null;
  if (!frame) return;
  loading = true;
  const [width, height] = frame.size_px;
  const picture = new Image();
  const done = () => { loading = false; load_wanted(); };
  picture.onload = () => { draw_frame(frame, picture.src, width || picture.width, height || picture.height); done(); };
  // Another frame has come, or this one cannot be read.
  picture.onerror = () => { if (!has_image) note(`${frame.name} cannot be shown`); done(); };
  picture.src = `/preview/${frame.number}`;
}

// Words in place of an image.
function note(sentence) {
  const svg = $("preview").querySelector("svg");
  svg.setAttribute("aria-label", sentence);
  svg.querySelector("text").textContent = sentence;
}

function draw_frame(frame, href, width, height) {
  has_image = true;
  const svg = $("preview").querySelector("svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("aria-label", `The newest photo, with ${frame.tags.length} tags outlined`);
  const outline = (kind) => (tag) => make("polygon", { points: tag.corners_px.join(" "), class: kind(tag) });
  svg.replaceChildren(
    make("image", { href, width, height }),
    ...frame.tags.map(outline(() => "under")),
    ...frame.tags.map(outline((tag) => (tag.is_whole ? "whole" : "covered"))),
  );
  const from = frame.viewpoint;
  const where = from ? ` · ${from.azimuth_deg.toFixed(0)}° round, ${from.pitch_deg.toFixed(0)}° up, ` +
    `${(from.distance_mm / 10).toFixed(0)} cm away` : "";
  $("caption").textContent = `${frame.name} · ${frame.tags.length} tags${where}`;
}

// --- meters and the list of views -----------------------------------------------------------------------------------

function draw_meters(meters) {
  $("meters").replaceChildren(...meters.map((meter) => {
    const box = make("div", { class: "meter" });
    const track = make("div", { class: "track", role: "meter", "aria-label": meter.name, "aria-valuemin": 0, "aria-valuemax": 100,
      "aria-valuenow": Math.round(100 * (meter.position || 0)), "aria-valuetext": meter.text });
    const zone = make("div", { class: "zone" });
    zone.style.left = `${100 * meter.good_zone[0]}%`;
    zone.style.right = `${100 * (1 - meter.good_zone[1])}%`;
    if (meter.position !== null) {
      const needle = make("div", { class: "needle" });
      needle.style.left = `${100 * meter.position}%`;
      track.append(zone, needle);
    }
    box.append(make("b", {}, meter.name), track, make("small", { class: meter.is_good === false ? "bad" : "" }, meter.text));
    return box;
  }));
}

let listed = "";

function draw_views(state, next) {
  // Only when it changes: a button that is being pressed must not be taken away.
  const now = JSON.stringify([state.views, state.next, state.ended]);
  if (now === listed) return;
  listed = now;
  const focused = document.activeElement && document.activeElement.dataset.sector;
  $("list").replaceChildren(...state.views.map((view) => {
    const item = make("li", { class: `${view.state}${view === next ? " next" : ""}` });
    if (view.photo) item.append(make("img", { src: `/photo/${encodeURIComponent(view.photo)}`, alt: "", loading: "lazy" }));
    else item.append(make("div", { class: "blank", "aria-hidden": "true" }, view.state === "redo" ? "↻" : "○"));
    const state_word = view === next && view.state !== "ok" ? `${WORDS[view.state]}, next` : WORDS[view.state];
    item.append(make("b", {}, `${MARKS[view.state]} ${state_word}`.trim()), make("span", {}, view.name));
    if (view.photo && !state.ended) {
      const name = state.sectors[view.sector].name;
      const button = make("button", { type: "button", "data-sector": view.sector, "aria-label": `Redo ${view.name}` }, `Redo ${name}`);
      button.onclick = () => post(`/redo/${view.sector}`);
      item.append(button);
    }
    return item;
  }));
  if (focused) ($("list").querySelector(`[data-sector="${focused}"]`) || $("undo")).focus();
}

// --- words and sounds -----------------------------------------------------------------------------------------------

function say(sentence, mood) {
  const advice = $("advice");
  advice.textContent = sentence;
  advice.dataset.mood = mood;
  advice.classList.toggle("long", sentence.length > 60);
}

// A running camera changes its advice many times a second; a voice can say one sentence in a while.
let spoken_at = 0;
let to_speak = null;

function speak(sentence) {
  if (sentence === $("spoken").textContent) { clearTimeout(to_speak); return; }
  clearTimeout(to_speak);
  const wait = Math.max(0, spoken_at + 1500 - Date.now());
  to_speak = setTimeout(() => { spoken_at = Date.now(); $("spoken").textContent = sentence; }, wait);
}

let audio = null;

$("sound").onclick = () => {
  const is_on = !audio;
  if (is_on) audio = new AudioContext();
  else { audio.close(); audio = null; }
  $("sound").setAttribute("aria-pressed", is_on);
  $("sound").textContent = is_on ? "Sound is on" : "Sound is off";
  if (is_on) tone(1);
};

// Two octaves from far away to on target.
function tone(closeness) {
  if (!audio) return;
  const [oscillator, gain, now] = [audio.createOscillator(), audio.createGain(), audio.currentTime];
  oscillator.frequency.value = 220 * 4 ** closeness;
  gain.gain.setValueAtTime(0.15, now);
  gain.gain.exponentialRampToValueAtTime(0.001, now + 0.15);
  oscillator.connect(gain).connect(audio.destination);
  oscillator.start(now);
  oscillator.stop(now + 0.16);
}

// Two bursts of noise, as a curtain opens and closes.
function shutter() {
  if (!audio) return;
  const samples = audio.createBuffer(1, audio.sampleRate * 0.12, audio.sampleRate);
  const data = samples.getChannelData(0);
  for (let i = 0; i < data.length; i++) {
    const t = i / audio.sampleRate;
    data[i] = (Math.random() * 2 - 1) * 0.5 * (Math.exp(-t * 120) + (t > 0.06 ? Math.exp(-(t - 0.06) * 120) : 0));
  }
  const source = audio.createBufferSource();
  source.buffer = samples;
  source.connect(audio.destination);
  source.start();
}

// --- news and buttons -----------------------------------------------------------------------------------------------

let last_frame = 0;

function show(state) {
  const { about, frame } = state;
  const next = state.next === null ? null : state.views[state.next];
  $("what").textContent = `${about.variant} at ${about.place}`;
  document.title = `${state.filled} of ${state.views.length} · ${about.variant} · scaleproof capture`;
  $("count").textContent = `${state.filled} of ${state.views.length} views`;
  $("source").textContent = state.source_ended && !state.ended ? `· the ${about.source} has ended` : "";
  $("file").hidden = $("send").hidden = about.is_stream || Boolean(state.ended);
  $("undo").disabled = $("finish").disabled = Boolean(state.ended);
  // By hand, whatever its light, focus and steadiness.
  const is_decided = Boolean(state.pairs && state.pairs.is_decided);
  $("file").disabled = is_decided;
  $("shoot").disabled = Boolean(state.ended) || is_decided || !frame || !frame.viewpoint || Boolean(frame.photo);
  $("pairs").hidden = !state.pairs;
  if (state.pairs) {
    const to_tell = next ? `; tells most next: ${next.name}` : "";
    $("pairs").textContent = state.pairs.is_decided ? `Decided: ${state.pairs.sentence}. No more photos are needed: press Finish`
      : `${state.pairs.sentence}${to_tell}`;
  }
  draw_dial(state, next);
  const is_new = frame && frame.number !== last_frame;
  // The newest photo is asked for before the small ones of the list.
  if (is_new) show_frame(frame);
  draw_views(state, next);
  if (is_new) {
    last_frame = frame.number;
    draw_meters(frame.meters);
    say(frame.advice, frame.photo ? "taken" : "todo");
    speak(frame.advice);
    if (frame.photo) shutter();
    else if (frame.viewpoint) tone(frame.closeness);
  } else if (!frame) {
    say(about.source === "upload" ? "Take the first photo" : "Waiting for the first photo", "waiting");
  }
  if (state.ended) { say(state.ended, "ended"); speak(state.ended); }
}

async function follow() {
  let seen = 0;
  for (;;) {
    try {
      const response = await fetch(`/state/${seen}`);
      if (!response.ok) throw new Error(await response.text());
      const state = await response.json();
      seen = state.revision;
      show(state);
      if (state.ended) return;
    } catch (e) {
      say(e instanceof TypeError ? "The capture cannot be reached: is it still running?" : e.message, "ended");
      await new Promise((after) => setTimeout(after, 2000));
    }
  }
}

async function post(path, body = null) {
  try {
    const headers = body ? { "Content-Type": body.type || "image/jpeg" } : {};
    const response = await fetch(path, { method: "POST", body, headers });
    if (response.status === 202) return;
    const told = await response.json();
    if (told.code) return; // the state shows it as a frame
    say(told.sentence, response.ok ? "waiting" : "todo");
    speak(told.sentence);
  } catch (e) {
    say("That could not be sent: is the capture still running?", "todo");
  }
}

$("shoot").onclick = () => post("/shoot");
$("undo").onclick = () => post("/undo");
$("finish").onclick = () => post("/finish");
$("file").onchange = async () => {
  const [photo] = $("file").files;
  if (!photo) return;
  // The server refuses it as well, but by closing the connection, of which a browser does not say why.
  if (photo.size > 32 * 2 ** 20) { say("The photo has more than 32 MB: let the camera make smaller photos", "todo"); return; }
  $("send").classList.add("busy");
  $("send").textContent = "Sending …";
  await post("/upload", photo);
  $("file").value = "";
  $("send").classList.remove("busy");
  $("send").textContent = "Take a photo";
};

follow();
