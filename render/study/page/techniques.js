// The pyramid of one method: what each technique (s, t) adds to the picture, a row per path length.

const pyramidView = {method: 0, noise: false, group: null};

/// Of the scene and method that are chosen; null where the study rendered none.
function pyramidData() {
  const techniques = pictureData[viewer.scene].techniques;
  return techniques && {...techniques, ...techniques.pyramids[pyramidView.method]};
}

function percent(share) {
  const value = 100 * share;
  return `${Math.abs(value) < 0.005 ? '0' : +value.toPrecision(value < 10 ? 2 : 3)} %`;
}

function showTechniqueCosts(costs) {
  const place = document.getElementById('technique-costs');
  place.replaceChildren();
  const seconds = costs.reduce((sum, cost) => sum + cost.seconds, 0);
  const order = cost => cost.order ? `${cost.order}${cost.order === 3 ? ' and later' : ''}` : '';
  const shareOf = value => value === undefined ? '' : percent(value);
  addTable(place, ['technique', 'eye vertex', 'energy', 'variance', 'time'], costs.map(cost =>
    [cost.technique, order(cost), shareOf(cost.energy), shareOf(cost.variance_share),
     percent(seconds > 0 ? cost.seconds / seconds : 0)]));
}

function showPyramids() {
  const data = pyramidData();
  document.getElementById('techniques').hidden = !data;
  pyramidView.group = null;
  if (!data) return;
  const layers = data.layers.map(layer => pyramidView.noise
    ? {s: layer.s, t: layer.t, share: layer.noise_share, pixels: layer.noise} : layer);
  pyramidView.group = {width: data.width, height: data.height, stops: data.stops,
                       pictures: layers};
  document.getElementById('pyramid-note').textContent =
    `${data.iterations} iterations, seed ${data.seed}, apart from the measured runs. Paths of more ` +
    `than ${data.edges} edges add ${percent(data.longer)} of the picture's mean.` +
    (data.shrink > 1 ? ` Shown at 1/${data.shrink} of their size.` : '');
  document.getElementById('pyramid-command').textContent = data.command_line;
  showTechniqueCosts(data.costs);
  const place = document.getElementById('pyramid');
  place.replaceChildren();
  place.style.setProperty('--columns', data.edges + 1);
  for (let edges = 1; edges <= data.edges; ++edges) {
    element('h4', `${edges} edge${edges > 1 ? 's' : ''}`, place);
    const row = element('div', null, place, 'pyramid-row');
    for (let s = 0; s <= edges; ++s) {
      const t = edges + 1 - s;
      const layer = layers.find(l => l.s === s && l.t === t);
      const name = `s = ${s}, t = ${t}`;
      if (layer) {
        addFigure(row, layer, pyramidView.group, `${name}: ${percent(layer.share)}`);
      } else {
        const cell = element('figure', null, row, 'none');
        cell.style.setProperty('--aspect', `${data.width} / ${data.height}`);
        element('div', null, cell);
        element('figcaption', `${name}: none`, cell);
      }
    }
  }
}

/// choice: {method} or {noise}
function choosePyramid(choice) {
  Object.assign(pyramidView, choice);
  showPyramids();
  developPyramid();
  paintPyramid();
}

function eachLayer(action) {
  const group = pyramidView.group;
  if (group) group.pictures.forEach(layer => action(layer, group));
}

function developPyramid() {
  eachLayer((layer, group) => develop(layer, group, false));
}

function paintPyramid() {
  eachLayer((layer, group) => paint(layer, group, viewer));
}
