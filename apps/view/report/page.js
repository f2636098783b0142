// Draws a run of `penumbra slam` or `penumbra brain`: the report from the JSON in #data, or what live.js fetches. Every section marks
// itself with data-drawn once it shows something; each may be drawn again with newer data.
'use strict';
const css = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const element = id => document.getElementById(id);
const fixed = (value, digits) => Number(value).toFixed(digits);
const counted = (count, one) => count === 1 ? `1 ${one}` : `${count} ${one}s`;
const problems = [];
window.addEventListener('error', event => complain(event.message));
function complain(text) {
  problems.push(text);
  const box = element('problem');
  box.hidden = false;
  box.textContent = problems.join('; ');
}

// What the run itself said is probably wrong with the recording.
function warnings(run) {
  const texts = [...(run.warnings || []), ...(run.why_lost ? [run.why_lost] : [])];
  element('warnings').hidden = texts.length === 0;
  element('warnings').replaceChildren(...texts.map(text => {
    const item = document.createElement('li');
    item.textContent = text;
    return item;
  }));
}

function show_section(id, shown) { element(id).hidden = !shown; }

function show_tiles(id, tiles) {
  element(id).replaceChildren(...tiles.map(([value, name]) => {
    const tile = document.createElement('div');
    tile.className = 'tile';
    tile.innerHTML = '<b></b><span></span>';
    tile.children[0].textContent = value;
    tile.children[1].textContent = name;
    return tile;
  }));
}

function summary(data) {
  const run = data.run, truth = run.ground_truth;
  const is_brain = run.system === 'brain';
  const map_size = is_brain ? [run.nodes, 'nodes'] : [run.map_points, 'map points'];
  element('headline').textContent = `${counted(run.frames, 'frame')}, ${run.tracked} located, ` +
      `${counted(run.keyframes, 'keyframe')}, ${counted(map_size[0], is_brain ? 'node' : 'map point')}`;
  if (run.error) complain(`The run stopped early: ${run.error}`);
  if (run.unfinished) complain('This is a checkpoint: the run did not come to its end');
  warnings(run);
  const tiles = [[run.frames, 'frames'], [run.lost, 'lost'], [run.keyframes, 'keyframes'], map_size,
                 [(run.loops || []).length, is_brain ? 'places recalled' : 'loops closed']];
  if (run.median_ms !== undefined) tiles.push([fixed(run.median_ms, 1) + ' ms', 'a frame, median']);
  if (run.p95_ms !== undefined) tiles.push([fixed(run.p95_ms, 1) + ' ms', '95 % of frames below']);
  if (run.disparity_offset_px) tiles.push([fixed(run.disparity_offset_px, 2) + ' px', 'disparity offset found']);
  if (run.path_m !== undefined) {
    tiles.push([fixed(run.path_m, 1) + ' m', 'path'], [fixed(run.mean_speed_mps, 2) + ' m/s', 'mean speed'],
               [fixed(run.median_depth_m, 1) + ' m', 'median depth of features']);
  }
  if (truth) {
    tiles.push([fixed(truth.ape_rmse_m, 3) + ' m', 'position error (APE rmse)']);
    if (truth.t_rel_percent !== undefined) {
      tiles.push([fixed(truth.t_rel_percent, 2) + ' %', 'drift'],
                 [fixed(truth.r_rel_deg_per_100m, 2) + '°', 'rotation drift per 100 m']);
    }
  }
  show_tiles('tiles', tiles);
  show_section('summary', true);
  element('summary').dataset.drawn = tiles.length;
}

// A plot area with axes; returns functions from values to pixels.
function axes(canvas, x_range, y_range, x_name, y_name) {
  const draw = canvas.getContext('2d'), left = 62, right = canvas.width - 14, top = 12, bottom = canvas.height - 36;
  const x = v => left + (v - x_range[0]) / (x_range[1] - x_range[0]) * (right - left);
  const y = v => bottom - (v - y_range[0]) / (y_range[1] - y_range[0]) * (bottom - top);
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.font = '13px system-ui, sans-serif';
  draw.lineWidth = 1;
  draw.strokeStyle = css('line');
  draw.fillStyle = css('quiet');
  const ticks = (range, count) => {
    const raw = (range[1] - range[0]) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map(f => f * power).find(s => s >= raw);
    const values = [];
    // From whole steps: sums of them end beside 0.
    for (let k = Math.ceil(range[0] / step); k * step <= range[1] + 1e-9; ++k) values.push(Number((k * step).toPrecision(6)));
    return values;
  };
  draw.textAlign = 'right'; draw.textBaseline = 'middle';
  for (const v of ticks(y_range, canvas.height / 60)) {
    draw.beginPath(); draw.moveTo(left, y(v)); draw.lineTo(right, y(v)); draw.stroke();
    draw.fillText(v, left - 6, y(v));
  }
  draw.textAlign = 'center'; draw.textBaseline = 'top';
  for (const v of ticks(x_range, 10)) {
    draw.beginPath(); draw.moveTo(x(v), top); draw.lineTo(x(v), bottom); draw.stroke();
    draw.fillText(v, x(v), bottom + 4);
  }
  draw.textAlign = 'right'; draw.textBaseline = 'bottom';
  draw.fillText(x_name, right, canvas.height - 2);
  draw.save(); draw.translate(12, top); draw.rotate(-Math.PI / 2); draw.textBaseline = 'middle';
  draw.fillText(y_name, 0, 0); draw.restore();
  return {draw, x, y, left, right, top, bottom};
}

const largest = values => values.reduce((a, b) => Math.max(a, b), 0);

// Axes of a map that shows all points [right, up], metres as long upwards as sideways.
function map_axes(canvas, all, x_name, y_name) {
  const range = k => [all.reduce((a, p) => Math.min(a, p[k]), Infinity), all.reduce((a, p) => Math.max(a, p[k]), -Infinity)];
  const [x0, x1] = range(0), [z0, z1] = range(1);
  const aspect = (canvas.width - 76) / (canvas.height - 48), pad = 0.06 * Math.max(x1 - x0, z1 - z0, 1);
  const height = Math.max(z1 - z0 + 2 * pad, (x1 - x0 + 2 * pad) / aspect), width = height * aspect;
  const mx = (x0 + x1) / 2, mz = (z0 + z1) / 2;
  return axes(canvas, [mx - width / 2, mx + width / 2], [mz - height / 2, mz + height / 2], x_name, y_name);
}

function path_from_above(data) {
  const canvas = element('top'), all = data.estimate.concat(data.truth).map(p => [p[0], p[2]]);
  const plot = map_axes(canvas, all, 'x, metres', 'z, metres');
  const line = (points, colour, thickness) => {
    plot.draw.strokeStyle = colour; plot.draw.lineWidth = thickness; plot.draw.beginPath();
    points.forEach((p, i) => plot.draw[i ? 'lineTo' : 'moveTo'](plot.x(p[0]), plot.y(p[2])));
    plot.draw.stroke();
  };
  if (data.truth.length) line(data.truth, css('truth'), 5);
  line(data.estimate, css('estimate'), 2);
  plot.draw.fillStyle = css('lost');
  for (const frame of data.lost) {
    const p = data.estimate[frame];
    if (p) plot.draw.fillRect(plot.x(p[0]) - 3, plot.y(p[2]) - 3, 6, 6);
  }
  for (const [a, b] of data.loops) {
    if (data.estimate[a] && data.estimate[b]) {
      line([data.estimate[a], data.estimate[b]], css('loop'), 2);
      plot.draw.fillStyle = css('loop');
      plot.draw.beginPath(); plot.draw.arc(plot.x(data.estimate[b][0]), plot.y(data.estimate[b][2]), 5, 0, 7); plot.draw.fill();
    }
  }
  canvas.dataset.drawn = data.estimate.length;
}

// Nodes and links, drawn as the path is: x to the right, z ahead. The robot's own plane has x ahead and y to its left.
function cognitive_map(data) {
  show_section('cognitive-section', Boolean(data.cognitive));
  if (!data.cognitive) return;
  const {nodes, links, places} = data.cognitive, at = nodes.map(([x, y]) => [-y, x]);
  const canvas = element('cognitive'), plot = map_axes(canvas, at, 'x, metres', 'z, metres');
  for (const recalled of [false, true]) {
    plot.draw.strokeStyle = css(recalled ? 'loop' : 'estimate');
    plot.draw.lineWidth = recalled ? 2 : 1;
    plot.draw.beginPath();
    for (const [a, b, by_recall] of links) {
      if (by_recall !== recalled || !at[a] || !at[b]) continue;
      plot.draw.moveTo(plot.x(at[a][0]), plot.y(at[a][1]));
      plot.draw.lineTo(plot.x(at[b][0]), plot.y(at[b][1]));
    }
    plot.draw.stroke();
  }
  plot.draw.fillStyle = css('estimate');
  for (const [x, y] of at) { plot.draw.beginPath(); plot.draw.arc(plot.x(x), plot.y(y), 2.5, 0, 7); plot.draw.fill(); }
  canvas.dataset.drawn = nodes.length;
  element('places-figure').hidden = !places;
  if (places) element('places').src = 'data:image/png;base64,' + places;
}

function curve(id, values, y_name, colour) {
  const canvas = element(id);
  const plot = axes(canvas, [0, Math.max(1, values.length - 1)], [0, largest(values) * 1.05 || 1], 'frame', y_name);
  plot.draw.strokeStyle = colour; plot.draw.lineWidth = 1.5; plot.draw.beginPath();
  const known = v => v !== null && v !== undefined;
  values.forEach((v, i) => { if (known(v)) plot.draw[known(values[i - 1]) ? 'lineTo' : 'moveTo'](plot.x(i), plot.y(v)); });
  plot.draw.stroke();
  canvas.dataset.drawn = values.length;
}

function table(id, rows) {
  element(id).querySelectorAll('tr').forEach(row => row.remove());
  for (const cells of rows) {
    const row = element(id).insertRow();
    for (const cell of cells) {
      const at = row.insertCell();
      if (cell instanceof Node) { at.className = 'bar'; at.append(cell); } else { at.textContent = cell; }
    }
  }
}

function times(data) {
  curve('time', data.frames.ms, 'milliseconds', css('estimate'));
  const stages = Object.entries(data.run.stages || {}).sort((a, b) => b[1] - a[1]);
  show_section('stages', stages.length > 0);
  table('stages', stages.map(([name, ms]) => {
    const bar = document.createElement('i');
    bar.style.width = 100 * ms / (stages[0][1] || 1) + '%';
    return [name.replaceAll('_', ' '), fixed(ms, 2) + ' ms', bar];
  }));
}

function filter(data) {
  const slider = element('filter-frame'), frames = data.frames.filter;
  const usable = frames.map((f, i) => i).filter(i => frames[i] && frames[i].kept.length);
  show_section('filter-section', usable.length > 0);
  if (!usable.length) return;
  slider.max = usable.length - 1;
  // What is voted on: the distance moved, or what of it was not expected.
  const compensated = (data.run.settings || {}).mismatch_filter === 'compensated';
  const quantity = compensated ? 'pixels from where it was expected' : 'pixels moved';
  const show = () => {
    const number = usable[slider.value], {from, width, kept, removed} = frames[number];
    element('filter-number').textContent = data.frames.index[number];
    const totals = kept.map((k, i) => k + removed[i]);
    const plot = axes(element('filter'), [from, from + width * kept.length], [0, largest(totals) * 1.05 || 1],
                      quantity, 'pairs');
    kept.forEach((k, i) => {
      const x = plot.x(from + i * width), w = Math.max(1, plot.x(from + (i + 1) * width) - x - 1);
      plot.draw.fillStyle = css('kept'); plot.draw.fillRect(x, plot.y(k), w, plot.bottom - plot.y(k));
      plot.draw.fillStyle = css('removed');
      plot.draw.fillRect(x, plot.y(totals[i]), w, plot.y(k) - plot.y(totals[i]));
    });
    element('filter').dataset.drawn = totals.length;
  };
  slider.addEventListener('input', show);
  slider.value = Math.floor(usable.length / 2);
  show();
}

function gallery(data) {
  show_section('gallery-section', data.gallery.length > 0);
  if (!data.gallery.length) return;
  for (const {name, image} of data.gallery) {
    const figure = document.createElement('figure'), picture = document.createElement('img');
    picture.src = 'data:image/jpeg;base64,' + image;
    picture.alt = `Keyframe ${name} with its features`;
    picture.loading = 'lazy';
    const caption = document.createElement('figcaption');
    caption.textContent = `frame ${Number(name)}`;
    figure.append(picture, caption);
    element('gallery').append(figure);
  }
  element('gallery').dataset.drawn = data.gallery.length;
}

const bytes_of = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

// The camera looks along +z with y down; on the screen y goes up, so y and z change sign.
const on_screen = p => new THREE.Vector3(p[0], -p[1], -p[2]);

// An empty scene with its camera; null where the browser has no WebGL.
function make_space() {
  const box = element('space');
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
  } catch (error) {
    box.innerHTML = '<p>This browser shows no WebGL; the path from above is the same data.</p>';
    box.dataset.drawn = 'none';
    return null;
  }
  renderer.setSize(box.clientWidth, box.clientHeight, false);
  box.append(renderer.domElement);
  const scene = new THREE.Scene(), lines = new THREE.Group();
  scene.background = new THREE.Color(0x10151c);
  const cloud = new THREE.Points(new THREE.BufferGeometry(),
      new THREE.PointsMaterial({size: 2, sizeAttenuation: false, vertexColors: THREE.VertexColors}));
  cloud.frustumCulled = false;
  scene.add(cloud, lines);
  const camera = new THREE.PerspectiveCamera(55, box.clientWidth / box.clientHeight, 0.1, 20000);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  const space = {box, lines, cloud, camera, controls, points: null, turned: false};
  space.draw = () => renderer.render(scene, camera);
  controls.addEventListener('start', () => { space.turned = true; });
  controls.addEventListener('change', space.draw);
  window.addEventListener('resize', () => {
    camera.aspect = box.clientWidth / box.clientHeight;
    camera.updateProjectionMatrix();
    renderer.setSize(box.clientWidth, box.clientHeight, false);
    space.draw();
  });
  return space;
}

// Colours of classes, a byte each, far apart in hue; what has no class is grey.
function class_colours(labels) {
  const colours = new Uint8Array(3 * labels.length), colour = new THREE.Color();
  labels.forEach((label, i) => {
    if (label) colour.setHSL(label * 0.381966 % 1, 0.75, 0.55); else colour.setRGB(0.45, 0.45, 0.45);
    colours.set([255 * colour.r, 255 * colour.g, 255 * colour.b], 3 * i);
  });
  return colours;
}

// What the space shows: the map's points, or the dense map in colours or by class.
function chosen_points(data) {
  const choice = data.dense ? element('space-shows').value : 'points';
  if (choice === 'points') return {position: data.points.position, colours: () => bytes_of(data.points.colour), key: data.points};
  const colours = choice === 'colour' ? () => bytes_of(data.dense.colour) : () => class_colours(bytes_of(data.dense.label));
  return {position: data.dense.position, colours, key: choice};
}

function dense_choice(data) {
  element('space-choice').hidden = !data.dense;
  if (!data.dense) return;
  const shown = new Set(bytes_of(data.dense.label));
  const names = [...shown].sort((a, b) => a - b).map(label => {
    const item = document.createElement('span'), [r, g, b] = class_colours([label]);
    item.textContent = (data.dense.classes[label] || 'no class') + ' ';
    item.style.color = `rgb(${r}, ${g}, ${b})`;
    return item;
  });
  const choose = () => {
    element('space-classes').replaceChildren(...(element('space-shows').value === 'class' ? names : []));
    path_in_space(data);
  };
  element('space-shows').addEventListener('change', choose);
  element('space-shows').value = 'colour';
}

let space;
function path_in_space(data) {
  if (space === undefined) space = make_space();
  if (space === null) return;
  const chosen = chosen_points(data);
  if (space.points !== chosen.key) {
    space.points = chosen.key;
    const positions = new Float32Array(bytes_of(chosen.position).buffer);
    space.cloud.geometry.dispose();
    space.cloud.geometry = new THREE.BufferGeometry();
    space.cloud.geometry.setAttribute('position', new THREE.BufferAttribute(positions.map((v, i) => i % 3 ? -v : v), 3));
    space.cloud.geometry.setAttribute('color', new THREE.BufferAttribute(chosen.colours(), 3, true));
    space.box.dataset.drawn = positions.length / 3;
  }
  for (const old of [...space.lines.children]) {
    space.lines.remove(old);
    old.geometry.dispose();
    old.material.dispose();
  }
  const line = (points, colour) => space.lines.add(new THREE.Line(
      new THREE.BufferGeometry().setFromPoints(points.map(on_screen)), new THREE.LineBasicMaterial({color: colour})));
  if (data.truth.length) line(data.truth, 0xd0d6dd);
  line(data.estimate, 0x4aa3ff);
  for (const [a, b] of data.loops) {
    if (data.estimate[a] && data.estimate[b]) line([data.estimate[a], data.estimate[b]], 0xc77dff);
  }
  if (!space.turned) {  // until somebody takes it
    const bounds = new THREE.Box3().setFromPoints(data.estimate.map(on_screen));
    const middle = bounds.getCenter(new THREE.Vector3()), size = Math.max(data.dense ? 4 : 10, bounds.getSize(new THREE.Vector3()).length());
    space.controls.target.copy(middle);
    space.camera.position.set(middle.x, middle.y + 0.7 * size, middle.z + 0.7 * size);
    space.controls.update();
  }
  space.draw();
}

// A picture of one colour shows nothing.
function is_empty(canvas) {
  const copy = document.createElement('canvas');
  copy.width = canvas.width; copy.height = canvas.height;
  copy.getContext('2d').drawImage(canvas, 0, 0);
  const pixels = new Uint32Array(copy.getContext('2d').getImageData(0, 0, copy.width, copy.height).data.buffer);
  return pixels.every(p => p === pixels[0]);
}
function check_pictures() {
  for (const canvas of document.querySelectorAll('canvas')) {
    if (!canvas.closest('section').hidden && is_empty(canvas)) complain(`The picture ${canvas.id || 'in space'} is empty`);
  }
}

function show_report(data) {
  summary(data);
  path_from_above(data);
  show_section('error-section', data.error.length > 0);
  if (data.error.length) curve('error', data.error, 'metres', css('lost'));
  cognitive_map(data);
  times(data);
  filter(data);
  gallery(data);
  element('command').textContent = data.run.command ? `${data.run.command}     # penumbra ${data.run.version}` : '';
  table('settings', Object.entries(data.run.settings || {}).map(([k, v]) => [k.replaceAll('_', ' '), JSON.stringify(v)]));
  show_section('settings-section', true);
  dense_choice(data);
  path_in_space(data);
  check_pictures();
  document.body.dataset.ready = problems.length ? 'with problems' : 'yes';
}

const finished_run = JSON.parse(element('data').textContent);
if (finished_run) show_report(finished_run);
