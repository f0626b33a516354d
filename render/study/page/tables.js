// Tables, and what was run.

function element(name, text, parent, className) {
  const e = document.createElement(name);
  if (text !== null) e.textContent = text;
  if (className) e.className = className;
  if (parent) parent.appendChild(e);
  return e;
}

function addTable(parent, columns, rows) {
  const table = element('table', null, parent);
  const head = element('tr', null, element('thead', null, table));
  for (const column of columns) element('th', column, head);
  const body = element('tbody', null, table);
  for (const row of rows) {
    const line = element('tr', null, body);
    for (const cell of row) {
      const flagged = cell.startsWith('too noisy') || cell.startsWith('its error');
      element('td', cell, line, flagged ? 'flag' : '');
    }
  }
}

function showTables(view) {
  const place = document.getElementById('tables');
  place.replaceChildren();
  for (const table of study.tables) {
    const filters = {scene: study.scenes[view.scene].name, measure: view.measure};
    const rows = table.rows.filter(row =>
      table.columns.every((column, c) => !(column in filters) || filters[column] === row[c]));
    if (rows.length === 0) continue;
    const kept = table.columns.map((column, c) => c).filter(c => !(table.columns[c] in filters));
    const pick = row => kept.map(c => row[c]);
    element('h3', table.title, place);
    addTable(place, pick(table.columns), rows.map(pick));
    for (const note of table.notes) element('p', note, place, 'hint');
  }
}

function showReference(view) {
  const scene = study.scenes[view.scene], reference = scene.reference;
  const own = reference.own_error;
  document.getElementById('reference').textContent = `reference: ${reference.origin}; ` +
    (own ? `its own ${view.measure} is about ${+own[view.measure].toPrecision(2)}`
         : 'its own error is not known');
}

/// The parts of the page that no choice changes.
function showFacts() {
  for (const text of study.about) element('p', text, document.getElementById('about'));
  const count = (list, name) => `${list.length} ${name}${list.length > 1 ? 's' : ''}`;
  document.getElementById('summary').textContent = `${count(study.methods, 'setting')}, ` +
    `${count(study.scenes, 'scene')}, ${count(study.seeds, 'seed')}. ${study.machine}. ` +
    `Lacuna ${study.version}.`;
  const facts = document.getElementById('facts');
  addTable(facts, ['', ''], [
    ['study', study.file],
    ['machine', study.machine],
    ['lacuna-render', `${study.version}, hash ${study.renderer_hash}`],
    ['seeds', study.seeds.join(', ')],
  ]);
  addTable(facts, ['scene', 'file', 'pixels', 'longest path', 'hash', 'reference',
    'hash of reference'], study.scenes.map(s => [s.name, s.file, `${s.width} x ${s.height}`,
    `${s.max_depth} edges`, s.hash, s.reference.origin, s.reference.hash]));
  element('h3', 'Effects', facts);
  const first = study.runs.filter(r => r.seed === study.seeds[0]);
  addTable(facts, ['scene', 'setting', 'simulated', 'left out'], first.map(r => [
    study.scenes[r.scene].name, study.methods[r.method].name, r.effects.simulated.join(', '),
    r.effects.left_out.map(e => `${e} (${r.effects.reasons[e]})`).join(', ')]));

  const runs = document.getElementById('runs');
  element('h3', 'Runs, in the order in which they were made', runs);
  addTable(runs, ['scene', 'setting', 'seed', 'iterations', 'seconds', 'setup', 'threads',
    'stopped by', 'not finite', 'caches', 'command'], study.runs.map(r => [
    study.scenes[r.scene].name, study.methods[r.method].name, String(r.seed),
    String(r.iterations), r.seconds.toPrecision(4), r.setup_seconds.toPrecision(3),
    String(r.threads), r.stopped, String(r.invalid_samples),
    Object.entries(r.cache_hashes).map(([k, v]) => `${k} ${v}`).join(' '), r.command_line]));
  for (const cell of runs.querySelectorAll('td:last-child')) {
    const code = element('code', cell.textContent);
    cell.replaceChildren(code);
  }
}
