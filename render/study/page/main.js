// What is chosen at the top, and everything that follows from it.

const view = {scene: 0, measure: study.measures[0], setup: true};

function showPlots() {
  const axis = view.setup ? 'seconds_with_setup' : 'seconds';
  drawCurves('plot-time', view, axis, view.setup ? 'seconds, setup counted' : 'seconds');
  drawCurves('plot-iterations', view, 'iterations', 'iterations');
  drawKnobs(view);
  drawCosts(view);
  showTables(view);
  showReference(view);
}

function fillSelect(id, names, choose) {
  const select = document.getElementById(id);
  names.forEach((name, i) => { element('option', name, select).value = i; });
  select.addEventListener('change', () => {
    choose(Number(select.value));
    showPlots();
  });
}

fillSelect('scene', study.scenes.map(s => s.name), i => {
  view.scene = i;
  showPictures(i);
});
study.methods.forEach((method, i) => {
  element('option', method.name, document.getElementById('pyramid-method')).value = i;
});
document.getElementById('pyramid-method').addEventListener('change',
  event => choosePyramid({method: Number(event.target.value)}));
document.getElementById('pyramid-show').addEventListener('change',
  event => choosePyramid({noise: event.target.value === 'noise'}));
fillSelect('measure', study.measures, i => { view.measure = study.measures[i]; });
document.getElementById('setup').addEventListener('change', event => {
  view.setup = event.target.checked;
  showPlots();
});
for (const [id, key] of [['flip', 'f'], ['error', 'e'], ['reset', '0']]) {
  document.getElementById(id).addEventListener('click', kActions[key]);
}
document.getElementById('exposure').addEventListener('input',
  event => expose(Number(event.target.value)));
addEventListener('keydown', onKey);
addEventListener('resize', repaint);
showErrorScale();
showFacts();
showPlots();
showPictures(0);
