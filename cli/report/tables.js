'use strict';
// The tables of a report and the controls of its view. Whatever comes from a file becomes text, never markup: elements
// are made here alone, by `make`, and their contents are text nodes.

const report = JSON.parse(document.getElementById('data').textContent);
const { facts, scene } = report;
const byId = (id) => document.getElementById(id);

function make(tag, attributes, ...children) {
  const svg = ['svg', 'rect', 'line', 'text', 'title', 'g'].includes(tag);
  const element = svg ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === 'click') element.addEventListener('click', value);
    else if (name === 'style') Object.assign(element.style, value);
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((c) => c !== null && c !== undefined));
  return element;
}

// Three significant digits; whole numbers with all of theirs.
function number(value, digits = 3) {
  if (value === null || value === undefined) return 'no number';
  if (value === 0) return '0';
  if (Number.isInteger(value)) return value.toLocaleString('en-US').replaceAll(',', '\u202f');
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e5 ? Number(value.toPrecision(digits)).toString() : value.toExponential(digits - 1);
}
const placeText = (place) => `(${place.map((x) => Number(x.toPrecision(6))).join(', ')})`;
const css = (rgb) => `rgb(${rgb.map((c) => Math.round(255 * c)).join(',')})`;
const swatch = (rgb) => make('span', { class: 'swatch', style: { background: css(rgb) } });
const nameText = (name) => name || '(no name)';

// A place as every message of flowcage gives it: "(x, y, z)", in metres.
function placeIn(text) {
  const found = /\((-?[\d.]+(?:e[-+]?\d+)?), (-?[\d.]+(?:e[-+]?\d+)?), (-?[\d.]+(?:e[-+]?\d+)?)\)/.exec(text);
  return found ? found.slice(1).map(Number) : null;
}

let viewer = null;
try {
  viewer = new Viewer(byId('canvas'), scene);
} catch (problem) {
  byId('no-webgl').hidden = false;
  byId('controls').hidden = true;
}

function showButton(place, reach, worst) {
  if (!place || !viewer) return null;
  const click = () => {
    if (worst) setLayer('worst', true);
    viewer.flyTo(place, reach);
  };
  return make('button', { type: 'button', class: 'show', title: `fly to ${placeText(place)} m`, click }, 'show');
}

// rows: arrays of cells; a cell is text, an element or an array of them. text: columns that are no numbers.
function table(head, rows, text) {
  const cell = (tag, value, column) => make(tag, text.includes(column) ? { class: 'text' } : {},
    ...(Array.isArray(value) ? value : [value]));
  return make('div', { class: 'scroll' }, make('table', {},
    make('thead', {}, make('tr', {}, ...head.map((h, c) => cell('th', h, c)))),
    make('tbody', {}, ...rows.map((row) => make('tr', {}, ...row.map((v, c) => cell('td', v, c)))))));
}
const facet = (pairs) => make('dl', {}, ...pairs.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)]));
const section = (title, ...children) => [make('h2', {}, title), ...children];

// Bars of counts on a logarithmic axis: one bad cell among a million is what one looks for.
function histogram(title, unit, data, limit) {
  const [width, height, left, bottom] = [420, 130, 52, 18];
  const most = Math.max(1, ...data.counts);
  const top = Math.ceil(Math.log10(most)) || 1;
  const x = (value) => left + (width - left - 8) * (value - data.low) / (data.high - data.low);
  const y = (count) => (height - bottom) * (1 - Math.log10(count) / top * 0.9);
  const floor = height - bottom;
  const svg = make('svg', { class: 'histogram', viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title });
  const step = (data.high - data.low) / data.counts.length;
  data.counts.forEach((count, bin) => {
    if (count === 0) return;
    const from = data.low + bin * step;
    const high = Math.min(y(count), floor - 4);
    svg.append(make('rect', { class: 'bar', x: x(from) + 0.5, width: Math.max(1, x(from + step) - x(from) - 1), y: high,
      height: floor - high }, make('title', {}, `${data.label(from)} to ${data.label(from + step)}: ${number(count)}`)));
  });
  for (let power = 0; power <= top; power += Math.ceil(top / 3)) {
    svg.append(make('text', { x: left - 6, y: Math.min(y(10 ** power), floor) + 4, 'text-anchor': 'end' },
      power < 5 ? number(10 ** power) : `1e${power}`));
  }
  svg.append(make('line', { class: 'axis', x1: left, x2: width - 8, y1: floor, y2: floor }));
  for (let tick = 0; tick <= data.ticks; ++tick) {
    const value = data.low + (data.high - data.low) * tick / data.ticks;
    svg.append(make('text', { x: x(value), y: floor + 13, 'text-anchor': tick === 0 ? 'start' : tick === data.ticks ?
      'end' : 'middle' }, data.label(value)));
  }
  if (limit !== undefined && limit.at <= data.high && limit.at >= data.low) {
    svg.append(make('line', { class: 'limit', x1: x(limit.at), x2: x(limit.at), y1: 4, y2: floor }));
    const late = x(limit.at) > 0.75 * width;
    svg.append(make('text', { x: x(limit.at) + (late ? -4 : 4), y: 12, 'text-anchor': late ? 'end' : 'start' },
      limit.name));
  }
  return [make('h3', {}, title, make('span', { class: 'soft' }, `  ${unit}; counts on a logarithmic axis`)), svg];
}

function gateSection() {
  const rows = facts.gates.map((gate) => [
    gate.name.replaceAll('_', ' '), number(gate.value), number(gate.limit),
    make('span', { class: gate.holds ? 'good-text' : 'bad-text' }, gate.holds ? 'holds' : 'missed'),
    [showButton(gate.place)],
  ]);
  const details = facts.gates.filter((g) => !g.holds).map((g) => make('li', {}, g.detail));
  return section('Gates', table(['gate', 'value', 'limit', '', ''], rows, [0]), make('ul', {}, ...details),
    make('p', { class: 'soft' }, `Deviations in diagonals of the CAD: 1 is ${number(scene.diagonal)} m.`));
}

function volumeSection() {
  const v = facts.volume;
  const pairs = [
    ['cells', `${number(v.cells)} in ${number(v.blocks)} blocks${facts.blocks ? ` (${facts.blocks.route})` : ''}`],
    ['points', number(v.points)],
    ['inverted cells', number(v.inverted_cells)],
    ['scaled Jacobian', `${number(v.min_scaled_jacobian)} at least, ${number(v.mean_scaled_jacobian)} on average`],
    ['non-orthogonality', `${number(v.max_non_orthogonality)}° at most, ${number(v.mean_non_orthogonality)}° on average`],
    ['skewness', `${number(v.max_skewness)} at most`],
    ['aspect ratio', `${number(v.max_aspect_ratio)} at most`],
    ['volume', `${number(v.total_volume, 6)} m³`],
  ];
  if (v.first_height.asked > 0) {
    const h = v.first_height;
    pairs.push(['first height',
      `${number(h.min)} to ${number(h.max)} ${report.unit}; asked for ${number(h.asked)} ${report.unit}`]);
  }
  const failures = v.check_mesh_failures;
  return section('Mesh', facet(pairs), failures.length
    ? make('ul', {}, ...failures.map((f) => make('li', {}, `checkMesh would complain: ${f}`)))
    : make('p', { class: 'soft' }, 'checkMesh would say: Mesh OK'));
}

function worstSection() {
  const names = { scaled_jacobian: 'scaled Jacobian', non_orthogonality: 'non-orthogonality, °', skewness: 'skewness',
    aspect_ratio: 'aspect ratio' };
  const cells = { scaled_jacobian: 0, non_orthogonality: 0, skewness: 0, aspect_ratio: 0 };
  const rows = [];
  for (const marked of scene.worst) {
    const rank = cells[marked.metric]++;
    if (rank > 2) continue;
    const worst = facts.volume.worst[marked.metric][rank];
    const p = decodeNumbers(marked.corners, Float32Array);
    const size = Math.hypot(p[18] - p[0], p[19] - p[1], p[20] - p[2]);
    rows.push([rank === 0 ? names[marked.metric] : '', number(worst.value), worst.cell, worst.block,
      [showButton(worst.place, 8 * size, true)]]);
  }
  return section('Worst cells', table(['metric', 'value', 'cell', 'block', ''], rows, [0]));
}

function warningSection() {
  const items = report.warnings.map((text) => make('li', {}, text, ' ', showButton(placeIn(text))));
  const title = report.command === 'inspect' ? 'Problems' : 'Warnings';
  return section(`${title} (${items.length})`,
    items.length ? make('ul', {}, ...items) : make('p', { class: 'soft' }, 'none'));
}

function markSection() {
  const rows = scene.marks.map((mark, index) => [[swatch(mark.color), `${index + 1}`], mark.text, [showButton(mark.place)]]);
  return section(`Open borders (${rows.length})`, rows.length ? table(['border', 'length: what it most likely is', ''], rows, [0, 1])
    : make('p', { class: 'soft' }, 'none'));
}

// A name with its colour and a box that hides what it names.
function nameCell(surface, index, shown) {
  const patch = scene[surface].names[index];
  const box = make('input', { type: 'checkbox', 'aria-label': `show ${nameText(patch.name)}` });
  box.checked = shown;
  if (viewer) viewer.setPatch(surface, index, shown);
  box.addEventListener('change', () => viewer && viewer.setPatch(surface, index, box.checked));
  return [make('label', {}, box, ' ', swatch(patch.color), nameText(patch.name))];
}

function cadNameSection() {
  const count = scene.cad.names.map((patch) => facts.cad.face_list.filter((face) => face.group === patch.name).length);
  return section('Patch names', table(['name', 'faces'],
    scene.cad.names.map((_, index) => [nameCell('cad', index, true), number(count[index])]), [0]));
}

function patchSection() {
  const summary = new Map((facts.patches || []).map((p) => [p.name, p]));
  const count = new Array(scene.mesh.names.length).fill(0);
  for (const name of decodeNumbers(scene.mesh.name, Int32Array)) ++count[name];
  const heights = (p) => (p && p.first_height ? `${number(p.first_height.min)} – ${number(p.first_height.max)}` : '');
  const rows = scene.mesh.names.map((patch, index) => {
    const p = summary.get(patch.name);
    return [nameCell('mesh', index, !['farfield', 'symmetry'].includes(patch.type)), patch.type,
      number(p ? p.faces : count[index]), p && p.max_deviation !== undefined ? number(p.max_deviation) : '',
      p && p.rms_deviation !== undefined ? number(p.rms_deviation) : '', heights(p)];
  });
  const volume = facts.volume !== undefined;
  const drop = (row) => (volume ? row : row.slice(0, 3));
  return section('Patches', table(drop(['patch', 'type', 'faces', 'max deviation', 'rms', `first height, ${report.unit}`]),
    rows.map(drop), [0, 1]));
}

function levelSection() {
  const rows = facts.surface.levels.map((l) => [number(l.level), number(l.control_vertices), number(l.max_deviation),
    number(l.rms_deviation), number(l.folds), number(l.passes), [showButton(l.worst_place)]]);
  return section('Levels of the fit', table(['level', 'vertices', 'max deviation', 'rms', 'folds', 'passes', ''], rows, []),
    make('p', { class: 'soft' }, `CAD to fitted surface: ${number(facts.surface.coverage_deviation)} at most.`));
}

function histogramSection() {
  const parts = [];
  const linear = (data, ticks) => ({ ...data, ticks, label: (v) => number(v) });
  if (facts.volume) {
    const h = facts.volume.histograms;
    parts.push(...histogram('Scaled Jacobian', 'cells', linear(h.scaled_jacobian, 5)),
      ...histogram('Non-orthogonality', 'inner faces, degrees', linear(h.non_orthogonality, 6),
        { at: 70, name: 'severe for checkMesh' }),
      ...histogram('Skewness', 'faces', linear(h.skewness, 4), { at: 4, name: 'limit of checkMesh' }));
  }
  if (scene.deviation) {
    const data = scene.deviation;
    parts.push(...histogram('Deviation', 'points of the wall, diagonals of the CAD',
      { ...data, ticks: data.high - data.low, label: (v) => (10 ** v).toExponential(0) },
      { at: Math.log10(scene.colors.deviation.bad), name: 'tolerance' }));
  }
  return section('Histograms', ...parts);
}

function cadSection() {
  const cad = facts.cad;
  const size = [0, 1, 2].map((a) => number(scene.body[1][a] - scene.body[0][a], 4)).join(' × ');
  const pairs = [['files', cad.files.join('\n')], ['unit of the file', cad.unit || 'not stated'], ['size', `${size} m`],
    ['diagonal', `${number(scene.diagonal, 5)} m`],
    ['faces, edges', `${number(cad.faces)}, ${number(cad.edges)} (${number(cad.sharp_edges)} sharp, ${number(cad.free_edges)} free)`]];
  if (facts.cage) {
    pairs.push(['cage', `${facts.cage.source}: ${number(facts.cage.vertices)} vertices, ${number(facts.cage.faces)} faces, genus ${
      facts.cage.genus}, ${number(facts.cage.crease_edges)} crease edges`]);
  }
  return section(facts.cage ? 'CAD and cage' : 'CAD', facet(pairs));
}

function aboutSection() {
  return section('What is shown', make('ul', {}, ...scene.shown.map((s) => make('li', {}, s))),
    make('p', { class: 'soft' }, 'Drag: turn; right button or two fingers: shift; wheel: nearer; click: what is there; ' +
      'double click: go there. A view can be kept in the address: #colour=quality&cut=y:0'),
    make('p', { class: 'soft' }, `flowcage ${facts.flowcage}. Pictures by three.js (MIT licence).`));
}

function fillPanel() {
  document.title = `${report.title} – flowcage ${report.command}`;
  const panel = byId('panel');
  panel.append(make('h1', {}, report.title), make('div', { class: 'soft' }, `flowcage ${report.command}`));
  if (facts.gates) {
    const missed = facts.gates.filter((g) => !g.holds).length;
    panel.append(make('div', { id: 'verdict', class: `verdict ${missed ? 'bad' : 'good'}` },
      missed ? `${missed} of ${facts.gates.length} gates missed` : `all ${facts.gates.length} gates hold`));
    panel.append(...gateSection());
  }
  panel.append(...warningSection());
  if (facts.volume) panel.append(...volumeSection());
  if (scene.mesh) panel.append(...patchSection());
  if (facts.surface) panel.append(...levelSection(), ...histogramSection());
  if (facts.volume) panel.append(...worstSection());
  if (facts.table) {
    panel.append(...markSection(), ...cadNameSection(), ...section('Facts', make('pre', {}, facts.table)));
  }
  panel.append(...cadSection(), ...aboutSection());
}

// The controls of the view.

function setLayer(name, on) {
  byId(`layer-${name}`).checked = on;
  viewer.setLayer(name, on);
}

const colourModes = () => {
  const modes = [];
  if (scene.mesh && scene.colors.deviation) modes.push(['deviation', 'deviation']);
  if (scene.volume) modes.push(['quality', 'quality (scaled Jacobian)']);
  modes.push(['patch', 'patch']);
  if (scene.volume) modes.push(['block', 'block']);
  return modes;
};

function fillLegend(mode) {
  const legend = byId('legend');
  legend.replaceChildren();
  const bar = (title, ends, failure) => {
    const stops = scene.colors.stops.map(css);
    legend.append(make('div', {}, title), make('div', { class: 'bar', style: { background:
      `linear-gradient(to right, ${stops.join(',')})` } }, ...ends.map((text, i) => make('span',
      { style: { left: `${100 * i / (ends.length - 1)}%` } }, text))),
    make('div', {}, swatch(scene.colors.failure), failure));
  };
  if (mode === 'deviation') {
    const { bad, good } = scene.colors.deviation;
    const ticks = [0, 1, 2, 3, 4].map((i) => number(bad * (good / bad) ** (i / 4), 1));
    bar('deviation from the CAD, in its diagonals', ticks, `above the tolerance, ${number(bad)}`);
  }
  if (mode === 'quality') bar('scaled Jacobian', ['0', '0.25', '0.5', '0.75', '1'], 'inverted or collapsed');
  if (mode === 'block') legend.append(`${number(facts.volume.blocks)} blocks; their colours repeat`);
}

function setUpControls() {
  const colour = byId('colour');
  colour.append(...colourModes().map(([value, text]) => make('option', { value }, text)));
  const setColour = (mode) => {
    colour.value = mode;
    viewer.setMode(mode);
    fillLegend(mode);
  };
  colour.addEventListener('change', () => setColour(colour.value));

  const layers = [['cad', 'CAD'], ['edges', 'CAD edges']];
  if (scene.mesh) layers.push(['mesh', 'mesh'], ['lines', 'lines']);
  if (scene.worst.length) layers.push(['worst', 'worst cells']);
  for (const [name, text] of layers) {
    const box = make('input', { type: 'checkbox', id: `layer-${name}` });
    box.checked = viewer.layers[name];
    box.addEventListener('change', () => viewer.setLayer(name, box.checked));
    byId('layers').append(make('label', {}, box, ` ${text}`));
  }
  const directions = { '⌂': [-1, -1.4, 0.8], '+x': [1, 0, 0], '-x': [-1, 0, 0], '+y': [0, 1, 0], '-y': [0, -1, 0],
    '+z': [0, -1e-3, 1], '-z': [0, -1e-3, -1] };
  for (const [text, direction] of Object.entries(directions)) {
    byId('views').append(make('button', { type: 'button', title: text === '⌂' ? 'the whole body' : `from ${text}`,
      click: () => viewer.look(direction) }, text));
  }
  const setCut = setUpCut();
  viewer.onPick = showPicked;
  viewer.onRender = drawTriad;

  // The view in the address: #colour=quality&cut=y:0.25&show=0, the last a number among the buttons "show".
  const wanted = new URLSearchParams(location.hash.slice(1));
  const modes = colourModes().map(([value]) => value);
  setColour(modes.includes(wanted.get('colour')) ? wanted.get('colour') : modes[0]);
  const cut = /^([xyz])(?::(-?[\d.eE+-]+))?$/.exec(wanted.get('cut') || '');
  if (cut) setCut('xyz'.indexOf(cut[1]), cut[2] === undefined ? undefined : Number(cut[2]));
  const show = document.querySelectorAll('button.show')[Number(wanted.get('show') || -1)];
  if (show) show.click();
}

// The slider's middle runs through the body, its ends to the far field. Returns a function that sets the cut.
function setUpCut() {
  const [axisBox, slider, valueBox] = ['cut-axis', 'cut-slider', 'cut-value'].map(byId);
  if (!scene.volume) {
    axisBox.parentElement.hidden = true;
    return () => {};
  }
  const inner = 0.7;
  const axis = () => ['x', 'y', 'z'].indexOf(axisBox.value);
  const ends = (a) => {
    const { body, all } = viewer.ranges(a);
    const [middle, half] = [(body[0] + body[1]) / 2, 0.55 * (body[1] - body[0])];
    return { middle, half, all };
  };
  const valueAt = (a, s) => {
    const { middle, half, all } = ends(a);
    if (Math.abs(s) <= inner) return Math.min(all[1], Math.max(all[0], middle + half * s / inner));
    const start = middle + Math.sign(s) * half;
    const end = s > 0 ? Math.max(all[1], start) : Math.min(all[0], start);
    return Math.min(all[1], Math.max(all[0], start + (end - start) * ((Math.abs(s) - inner) / (1 - inner)) ** 2));
  };
  const sliderAt = (a, value) => {
    let [low, high] = [-1, 1];
    while (high - low > 1e-4) {
      const middle = (low + high) / 2;
      if (valueAt(a, middle) < value) low = middle;
      else high = middle;
    }
    return low;
  };
  const apply = (a, value, keep) => {
    byId('cut-more').hidden = a < 0;
    axisBox.value = a < 0 ? '' : 'xyz'[a];
    viewer.setCut(a, value, keep);
    if (a >= 0) valueBox.value = Number(value.toPrecision(6));
  };
  // Beside the middle of the body, where lines of a symmetric mesh would coincide with the plane.
  const setCut = (a, value) => {
    const at = value === undefined && a >= 0 ? valueAt(a, 0.01) : value;
    apply(a, at);
    if (a >= 0) slider.value = sliderAt(a, at);
  };
  axisBox.addEventListener('change', () => setCut(axis()));
  slider.addEventListener('input', () => apply(axis(), valueAt(axis(), Number(slider.value)), viewer.cut.keep));
  valueBox.addEventListener('change', () => Number.isFinite(valueBox.valueAsNumber) && setCut(axis(), valueBox.valueAsNumber));
  byId('cut-whole').addEventListener('change', () => viewer.setWholeCells(byId('cut-whole').checked));
  byId('cut-flip').addEventListener('click', () => apply(axis(), Number(valueBox.value), -viewer.cut.keep));
  return setCut;
}

function showPicked(found) {
  const box = byId('picked');
  box.hidden = !found;
  if (!found) return;
  const lines = [];
  if (found.face) {
    const face = facts.cad.face_list && facts.cad.face_list[found.face.region];
    lines.push(face ? `face ${face.number}, ${face.kind}: ${nameText(face.group)}`
      : `${nameText(found.face.name)} (${found.face.type})`);
    if (found.face.deviation !== undefined) {
      lines.push(`deviation ${number(found.face.deviation)} = ${number(found.face.deviation * scene.diagonal)} m`);
    }
    if (found.face.quality !== undefined) lines.push(`scaled Jacobian ${number(found.face.quality)}`);
    if (found.face.block !== undefined) lines.push(`block ${found.face.block}`);
  } else {
    lines.push(`cell in the cut: scaled Jacobian ${number(found.cell.quality)}`);
  }
  lines.push(`${placeText(found.place.map((x) => Number(x.toPrecision(5))))} m`);
  box.textContent = lines.join('\n');
}

function drawTriad(camera) {
  const triad = byId('triad');
  triad.replaceChildren();
  const axes = [['x', '#c0392b', [1, 0, 0]], ['y', '#27843f', [0, 1, 0]], ['z', '#2463b5', [0, 0, 1]]];
  const turned = axes.map(([name, colour, direction]) => [name, colour,
    new THREE.Vector3(...direction).applyQuaternion(camera.quaternion.clone().inverse())]);
  for (const [name, colour, d] of turned.sort((a, b) => a[2].z - b[2].z)) {
    triad.append(make('line', { x1: 0, y1: 0, x2: 30 * d.x, y2: -30 * d.y, stroke: colour, 'stroke-width': 3 }),
      make('text', { x: 40 * d.x, y: -40 * d.y, fill: colour }, name));
  }
}

fillPanel();
if (viewer) setUpControls();
