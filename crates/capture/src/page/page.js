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

// The newest frame of the state, and the number of the last one that was shown.
let newest = null;
let last_frame = 0;

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
  svg.setAttribute("viewBox", "0 0 4 3");
  svg.setAttribute("aria-label", sentence);
  svg.replaceChildren(make("text", { x: 2, y: 1.5 }, sentence));
}

// Without an image (`href`) over what this device films.
function draw_frame(frame, href, width, height, ground = []) {
  has_image = Boolean(href);
  const svg = $("preview").querySelector("svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("aria-label", `The newest picture, with ${frame.tags.length} tags outlined`);
  const outline = (kind) => (tag) => make("polygon", { points: tag.corners_px.join(" "), class: kind(tag) });
  svg.replaceChildren(
    ...(href ? [make("image", { href, width, height })] : ground),
    ...frame.tags.map(outline(() => "under")),
    ...frame.tags.map(outline((tag) => (tag.is_whole ? "whole" : "covered"))),
  );
  const from = frame.viewpoint;
  const where = from ? ` · ${from.azimuth_deg.toFixed(0)}° round, ${from.pitch_deg.toFixed(0)}° up, ` +
    `${(from.distance_mm / 10).toFixed(0)} cm away` : "";
  $("caption").textContent = `${frame.name} · ${frame.tags.length} tags${where}`;
}

// --- filming: pictures of this device's camera, one on its way at a time -----------------------------------------------

// Longest side of the small pictures that are sent until one is wanted whole.
const SMALL_PX = 1280;
const LEAST_MS = 100;

let film = null;
let outdated = null;
let camera_px = [1280, 960];

const NO_CAMERA = {
  NotAllowedError: "The browser may not use the camera: allow it for this page",
  NotFoundError: "This device has no camera",
  NotReadableError: "Another program is using the camera: close it",
};

$("film").onclick = () => (film ? end_film("") : begin_film());

async function begin_film() {
  const is_secure = window.isSecureContext && navigator.mediaDevices;
  if (!is_secure) { refuse("Browsers film only on a page with https://, or on the machine of the capture"); return; }
  const [width, height] = camera_px;
  // Only sizes that the camera has: a browser would cut others out of them.
  const video = { facingMode: "environment", width: { ideal: width }, height: { ideal: height }, resizeMode: { exact: "none" } };
  try {
    const stream = await navigator.mediaDevices.getUserMedia({ video });
    film = { stream, device: crypto.getRandomValues(new Uint32Array(1))[0], drawn_at: 0, is_by_hand: false };
    stream.getVideoTracks()[0].onended = () => end_film("The camera has ended");
    $("video").srcObject = stream;
    await $("video").play();
  } catch (e) {
    end_film("");
    refuse(NO_CAMERA[e.name] || `The camera cannot be used (${e.name})`);
    return;
  }
  show_film();
  send_film(film);
}

function refuse(sentence) {
  say(`${sentence}. Photos can be sent all the same`, "todo");
  speak(sentence);
}

function end_film(sentence) {
  if (film) for (const track of film.stream.getTracks()) track.stop();
  film = null;
  $("video").srcObject = null;
  show_film();
  if (sentence) refuse(sentence);
}

function show_film() {
  const is_on = Boolean(film);
  document.querySelector("main").classList.toggle("filming", is_on);
  $("video").hidden = $("keep").hidden = !is_on;
  $("film").textContent = is_on ? "End filming" : "Film with this device's camera";
  $("shoot").disabled = !is_on;
  has_image = false;
  $("caption").textContent = "";
  if (!is_on && newest) show_frame(newest);
  else note(is_on ? "" : "no photo yet");
}

// A picture that the camera has made since the last one: of a film that stands still, nothing is sent.
function new_picture(video) {
  return new Promise((seen) => {
    if (video.requestVideoFrameCallback) { video.requestVideoFrameCallback(seen); return; }
    const before = video.currentTime;
    const look = () => (video.currentTime === before ? requestAnimationFrame(look) : seen());
    look();
  });
}

function picture(is_whole) {
  const video = $("video");
  const [width, height] = [video.videoWidth, video.videoHeight];
  const scale = is_whole ? 1 : Math.min(1, SMALL_PX / Math.max(width, height));
  const canvas = make("canvas", { width: Math.round(width * scale), height: Math.round(height * scale) });
  canvas.getContext("2d").drawImage(video, 0, 0, canvas.width, canvas.height);
  return new Promise((made) => canvas.toBlob(made, "image/jpeg", is_whole ? 0.95 : 0.7));
}

// Why what this device films cannot be located, or nothing.
function misfit() {
  const own = [$("video").videoWidth, $("video").videoHeight];
  if (own.join() === camera_px.join()) return "";
  if (own.join() === [...camera_px].reverse().join()) return "Turn the device on its side, as it was when its camera file was made";
  return `This film is ${own.join("×")} and the camera file for ${camera_px.join("×")}: save pictures of a board, and calibrate with them`;
}

async function send_film(own) {
  let is_whole = false;
  while (film === own) {
    const wait = new Promise((after) => setTimeout(after, LEAST_MS));
    await new_picture($("video"));
    if (film !== own) return;
    const fault = misfit();
    if (fault) {
      is_whole = false;
      note("");
      say(fault, "todo");
      await wait;
      continue;
    }
    const is_by_hand = own.is_by_hand;
    own.is_by_hand = false;
    const kind = is_whole || is_by_hand ? "whole" : "preview";
    const now = performance.now();
    const after_ms = Math.min(Math.round(now - own.drawn_at), 10000);
    own.drawn_at = now;
    const body = await picture(kind === "whole");
    try {
      const headers = { "Content-Type": "image/jpeg" };
      const response = await fetch(`/film/${own.device}/${kind}/${after_ms}`, { method: "POST", body, headers });
      const told = await response.json();
      if (!response.ok) { if (film === own) end_film(told.sentence); return; }
      is_whole = told.wants_whole;
      if (is_by_hand && !told.photo) await post("/shoot");
    } catch (e) {
      is_whole = false;
      say("The film could not be sent: is the capture still running?", "todo");
      await new Promise((after) => setTimeout(after, 1000));
    }
    await wait;
  }
}

// Over what this device films: the views on the ground about the model, and the tags.
function draw_film(state, next) {
  const [width, height] = state.frame.size_px;
  if (!width) return;
  const ground = state.frame.film.ground_px.map((points, index) => make("polygon", {
    points: points.join(" "), class: `ground ${state.sectors[index].state}${next && next.sector === index ? " next" : ""}`,
  }));
  // The border of the next lies above its neighbours'.
  ground.sort((a, b) => a.classList.contains("next") - b.classList.contains("next"));
  draw_frame(state.frame, null, width, height, ground);
  // What is drawn belongs to a picture that is soon past.
  clearTimeout(outdated);
  outdated = setTimeout(() => { if (film) note(""); }, 1500);
}

let kept = 0;

$("keep").onclick = async () => {
  const href = URL.createObjectURL(await picture(true));
  kept += 1;
  make("a", { href, download: `film_${String(kept).padStart(3, "0")}.jpg` }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60000);
};

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


function show(state) {
  const { about, frame } = state;
  const next = state.next === null ? null : state.views[state.next];
  $("what").textContent = `${about.variant} at ${about.place}`;
  document.title = `${state.filled} of ${state.views.length} · ${about.variant} · scaleproof capture`;
  $("count").textContent = `${state.filled} of ${state.views.length} views`;
  $("source").textContent = state.source_ended && !state.ended ? `· the ${about.source} has ended` : "";
  camera_px = about.camera_px;
  $("file").hidden = $("send").hidden = $("film").hidden = about.is_stream || Boolean(state.ended);
  $("undo").disabled = $("finish").disabled = Boolean(state.ended);
  // By hand, whatever its light, focus and steadiness.
  const is_decided = Boolean(state.pairs && state.pairs.is_decided);
  $("file").disabled = is_decided;
  if (film && (state.ended || is_decided)) end_film("");
  const can_shoot = film || (frame && !frame.film && frame.viewpoint && !frame.photo);
  $("shoot").disabled = Boolean(state.ended) || is_decided || !can_shoot;
  $("pairs").hidden = !state.pairs;
  if (state.pairs) {
    const to_tell = next ? `; tells most next: ${next.name}` : "";
    $("pairs").textContent = state.pairs.is_decided ? `Decided: ${state.pairs.sentence}. No more photos are needed: press Finish`
      : `${state.pairs.sentence}${to_tell}`;
  }
  draw_dial(state, next);
  newest = frame;
  const is_new = frame && frame.number !== last_frame;
  // The newest photo is asked for before the small ones of the list.
  if (is_new && !film) show_frame(frame);
  if (is_new && film && frame.film && frame.film.device === film.device) draw_film(state, next);
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

// Of a film the next picture, whole.
$("shoot").onclick = () => { if (film) film.is_by_hand = true; else post("/shoot"); };
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
