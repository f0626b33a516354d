'use strict';
// The plots: all that is computed was computed by lacuna-study; here it is only drawn.

const study = JSON.parse(document.getElementById('data').textContent);

// Told apart by most colour-blind readers too; the shape of the marks says the same again.
const kColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#444444',
  '#8b5a2b', '#6a3d9a', '#7f9f00'];
const kMarks = ['circle', 'rect', 'triangle', 'rectRot', 'crossRot', 'star'];
const colourOf = i => kColours[i % kColours.length];
const markOf = i => kMarks[i % kMarks.length];

const charts = {};

function erase(id) {
  if (charts[id]) charts[id].destroy();
  delete charts[id];
}

function draw(id, config) {
  erase(id);
  config.options = Object.assign(
      {animation: false, responsive: true, maintainAspectRatio: false}, config.options);
  charts[id] = new Chart(document.getElementById(id), config);
}

/// 1, 2, 3 and 5 times a power of ten, more where there is room; other ticks stay without a number.
function logTick(value, index, ticks) {
  const range = ticks[ticks.length - 1].value / ticks[0].value;
  if (range < 3) return String(+value.toPrecision(2));
  const mantissa = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
  return (range < 10 ? [1, 2, 3, 4, 5, 7] : [1, 2, 3, 5]).some(m => Math.abs(mantissa - m) < 1e-6) ? String(+value.toPrecision(1)) : '';
}

function logAxis(title) {
  return {type: 'logarithmic', title: {display: true, text: title}, ticks: {callback: logTick}};
}

const kFinite = point => point.every(value => value !== null && value > 0);

/// Limits of a logarithmic axis that leave little empty; the decades around where there is nothing.
function logRange(values) {
  const usable = values.filter(v => v !== null && v > 0);
  return usable.length && {min: Math.min(...usable) / 1.1, max: Math.max(...usable) * 1.1};
}

/// What an axis of errors is called: two measures are radiances, the others have no unit.
const kMeasureTitles = {mae: 'mae (radiance)', rmse: 'rmse (radiance)',
  mape: 'mape (1 = 100 %)', relmse: 'relmse (1 = 100 % of radiance squared)'};

/// For a legend: the edges of bands are left out.
const kMedians = (item, data) => !data.datasets[item.datasetIndex].edge;

/// A median's line and the band between lowest and highest, which belong together.
function bandDatasets(points, label, index) {
  const usable = points.filter(kFinite);
  const line = column => usable.map(p => ({x: p[0], y: p[column]}));
  const edge = {label, method: index, edge: true, borderWidth: 0, pointRadius: 0, hitRadius: 0};
  return [
    {label, method: index, data: line(1), borderColor: colourOf(index), borderWidth: 2,
     backgroundColor: colourOf(index), pointStyle: markOf(index), pointRadius: 3},
    {...edge, data: line(2)},
    {...edge, data: line(3), fill: '-1', backgroundColor: colourOf(index) + '30'},
  ];
}

function horizontal(label, y, range, style) {
  return {label, data: range.map(x => ({x, y})), borderWidth: 1.5, pointRadius: 0, hitRadius: 0,
          pointStyle: 'line', ...style};
}

function drawCurves(id, view, axis, title) {
  const scene = study.scenes[view.scene];
  const bands = study.bands[view.scene].map(byMeasure => byMeasure[view.measure][axis]);
  const datasets = bands.flatMap((points, m) => bandDatasets(points, study.methods[m].name, m));
  const xs = bands.flat().filter(kFinite).map(p => p[0]);
  const range = [Math.min(...xs), Math.max(...xs)];
  (scene.bounds[view.measure] || []).forEach((bound, i) => {  // one entry in the legend for all
    datasets.push(horizontal('bounds', bound, range,
                             {borderColor: '#999', borderDash: [6, 4], edge: i > 0}));
  });
  const own = scene.reference.own_error;
  if (own && own[view.measure] > 0) {
    datasets.push(horizontal('below: reference too noisy',
                             own[view.measure] * scene.reference.margins[view.measure], range,
                             {borderColor: '#c33', borderDash: [2, 3]}));
  }
  const legend = {
    labels: {usePointStyle: true, boxHeight: 6, filter: kMedians},
    onClick: (event, item, self) => {  // a median takes its band along
      const chart = self.chart, clicked = chart.data.datasets[item.datasetIndex];
      const visible = !chart.isDatasetVisible(item.datasetIndex);
      chart.data.datasets.forEach((d, i) => {
        if (d.label === clicked.label) chart.setDatasetVisibility(i, visible);
      });
      chart.update();
    },
  };
  const tooltip = {
    callbacks: {label: c => `${c.dataset.label}: ${+c.parsed.y.toPrecision(3)} at ` +
        `${+c.parsed.x.toPrecision(3)}`, title: () => ''},
  };
  draw(id, {
    type: 'line',
    data: {datasets},
    options: {
      parsing: false,
      scales: {
        x: {...logAxis(title), ...logRange(xs)},
        y: {...logAxis(kMeasureTitles[view.measure]),
            ...logRange(datasets.flatMap(d => d.data.map(p => p.y)))},
      },
      plugins: {legend, tooltip},
    },
  });
}

/// One bar per method, made of `parts`: names with their values by method.
function drawBars(id, parts, title) {
  const methods = study.methods.map(m => m.name);
  draw(id, {
    type: 'bar',
    data: {
      labels: methods,
      datasets: Object.entries(parts).map(([label, data], i) =>
        ({label, data, backgroundColor: colourOf(i)})),
    },
    options: {
      indexAxis: 'y',
      scales: {x: {stacked: true, title: {display: true, text: title}}, y: {stacked: true}},
      plugins: {legend: {display: Object.keys(parts).length > 1, labels: {boxWidth: 12}}},
    },
  });
}

/// {part: [value by method]} of the parts that any method has; those in `order` first.
function partsOf(costs, key, order, factor) {
  const names = [...new Set([...order, ...costs.flatMap(c => Object.keys(c[key]))])];
  const parts = {};
  for (const name of names) {
    const values = costs.map(c => (c[key][name] || 0) * factor);
    if (values.some(v => v > 0)) parts[name] = values;
  }
  return parts;
}

function drawCosts(view) {
  const costs = study.costs[view.scene];
  drawBars('plot-phases', partsOf(costs, 'phases', ['setup', 'warm-up', 'light paths', 'prepare',
    'eye paths', 'observe', 'other'], 1), 'seconds');
  drawBars('plot-rays', partsOf(costs, 'rays', [], 1e-6), 'million rays');
  drawBars('plot-memory', {memory: costs.map(c => c.peak_bytes / 2 ** 20)}, 'MiB');
}

/// A canvas in a figure of its own, made when it is first asked for.
function knobFigure(id, caption) {
  if (!document.getElementById(id)) {
    document.getElementById('knob-plots').insertAdjacentHTML('beforeend',
      `<figure><div><canvas id="${id}"></canvas></div><figcaption></figcaption></figure>`);
  }
  const figure = document.getElementById(id).closest('figure');
  figure.lastChild.textContent = caption;
  return figure;
}

/// Lines over a knob's values; what was not reached is a gap. `range`: of the vertical axis.
function drawKnob(id, knob, lines, title, range) {
  const datasets = lines.flatMap(({label, points}, i) => {
    const edge = {label, edge: true, borderWidth: 0, pointRadius: 0, hitRadius: 0};
    return [
      {label, data: points.map(p => p.median), borderColor: colourOf(i), pointRadius: 3,
       backgroundColor: colourOf(i), pointStyle: markOf(i)},
      {...edge, data: points.map(p => p.low)},
      {...edge, data: points.map(p => p.high), fill: '-1', backgroundColor: colourOf(i) + '30'},
    ];
  });
  draw(id, {
    type: 'line',
    data: {labels: knob.values, datasets},
    options: {
      scales: {
        x: {offset: true, title: {display: true, text: knob.knob}},
        y: {...logAxis(title), ...range},
      },
      plugins: {legend: {
        display: lines.length > 1,
        labels: {usePointStyle: true, boxHeight: 6, filter: kMedians},
      }},
    },
  });
}

function drawKnobs(view) {
  const knobs = study.knobs[view.scene][view.measure];
  document.getElementById('knobs').hidden = knobs.length === 0;
  // One scale for all plots of a kind: knobs are compared with each other too.
  const rangeOf = points => logRange(points.flatMap(Object.values));
  const errorRange = rangeOf(knobs.flatMap(k => [...k.errors, ...k.iteration_errors]));
  const timeRange = rangeOf(knobs.flatMap(k => k.times.flatMap(t => t.points)));
  knobs.forEach((knob, i) => {
    knobFigure(`plot-knob-iterations-${i}`, `${knob.group}: error after ${knob.iterations} ` +
      'iterations; median and range over seeds.');
    drawKnob(`plot-knob-iterations-${i}`, knob,
      [{label: knob.group, points: knob.iteration_errors}], kMeasureTitles[view.measure],
      errorRange);
    knobFigure(`plot-knob-${i}`, `${knob.group}: error after ${+knob.seconds.toPrecision(3)} s, ` +
      'setup counted; median and range over seeds.');
    drawKnob(`plot-knob-${i}`, knob, [{label: knob.group, points: knob.errors}],
      kMeasureTitles[view.measure], errorRange);
    const id = `plot-knob-time-${i}`;
    const bounds = knob.times.map(t => t.bound).join(', ');
    const figure = knobFigure(id, `${knob.group}: time to ${view.measure} ${bounds}, setup ` +
      'counted; a gap where it was not reached.');
    figure.hidden = knob.times.length === 0;
    erase(id);
    if (figure.hidden) return;
    drawKnob(id, knob, knob.times.map(t => ({label: `${view.measure} ${t.bound}`,
      points: t.points})), 'seconds', timeRange);
  });
}
