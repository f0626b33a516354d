// The pictures: radiance as halves, exposed here, so that every one is shown alike.

const pictureData = JSON.parse(document.getElementById('picture-data').textContent);

/// The value of every half.
const kHalf = Float32Array.from({length: 65536}, (_, bits) => {
  const sign = bits & 0x8000 ? -1 : 1, exponent = bits >> 10 & 31, mantissa = bits & 1023;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  return sign * (1 + mantissa / 1024) * 2 ** (exponent - 15);
});

function srgbByte(linear) {
  const x = Math.min(Math.max(linear, 0), 1);
  return Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
}

const viewer = {
  scene: 0, zoom: 1, x: 0.5, y: 0.5,  // (x, y): of the picture, in the middle of every view
  exposure: 0, error: false, flip: false, shown: 0,
};

const kWholePicture = {zoom: 1, x: 0.5, y: 0.5};

/// The halves of a picture, decoded once.
function halvesOf(picture) {
  if (!picture.halves) {
    const bytes = Uint8Array.from(atob(picture.pixels), c => c.charCodeAt(0));
    picture.halves = new Uint16Array(bytes.buffer);
  }
  return picture.halves;
}

// Pictures of one size stand together in a group {width, height, stops, pictures}: a scene, a crop
// of it, a method's techniques.

/// Index into the false colours by pixel: mean of |I - R| / (R + e), e = 0.01 mean R. R is the
/// group's first picture.
function errorsOf(picture, group) {
  if (picture.falseColours) return picture.falseColours;
  const image = halvesOf(picture), reference = halvesOf(group.pictures[0]);
  const e = 0.01 * reference.reduce((sum, h) => sum + kHalf[h], 0) / reference.length;
  const {low, high, colours} = study.error_map;
  const perIndex = (colours.length - 1) / Math.log(high / low);
  const indices = picture.falseColours = new Uint8Array(image.length / 3);
  for (let i = 0; i < indices.length; ++i) {
    let sum = 0;
    for (let c = 3 * i; c < 3 * i + 3; ++c) {
      const r = kHalf[reference[c]], difference = Math.abs(kHalf[image[c]] - r);
      sum += difference > 0 ? difference / (r + e) / 3 : 0;
    }
    indices[i] = Math.round(perIndex * Math.log(Math.min(Math.max(sum, low), high) / low));
  }
  return indices;
}

/// sRGB by half, for pictures that all have the same stops.
const exposed = {factor: 0, bytes: null};

function exposedBytes(stops) {
  const factor = 2 ** (viewer.exposure - stops);
  if (exposed.factor !== factor) {
    exposed.factor = factor;
    exposed.bytes = Uint8Array.from(kHalf, value => srgbByte(value * factor));
  }
  return exposed.bytes;
}

/// Fills the picture's own canvas, one pixel per pixel: radiance, or errors in false colour.
function develop(picture, group, error) {
  const context = picture.canvas.getContext('2d');
  const data = context.createImageData(group.width, group.height), out = data.data;
  if (error) {
    errorsOf(picture, group).forEach((index, i) => {
      out.set(study.error_map.colours[index], 4 * i);
      out[4 * i + 3] = 255;
    });
  } else {
    const bytes = exposedBytes(group.stops), halves = halvesOf(picture);
    for (let i = 0, j = 0; i < halves.length; i += 3, j += 4) {
      for (let c = 0; c < 3; ++c) out[j + c] = bytes[halves[i + c]];
      out[j + 3] = 255;
    }
  }
  context.putImageData(data, 0, 0);
}

/// From the picture's own canvas to what is seen of it through `shown` {zoom, x, y}. Returns the
/// view's context, in units of the picture's pixels; null where the view is hidden.
function paint(picture, group, shown) {
  const view = picture.view;
  if (!view.clientWidth) return null;
  view.width = Math.round(view.clientWidth * devicePixelRatio);
  view.height = Math.round(view.width * group.height / group.width);
  const scale = view.width / group.width * shown.zoom;
  const context = view.getContext('2d');
  context.imageSmoothingEnabled = false;
  context.setTransform(scale, 0, 0, scale, view.width / 2 - shown.x * group.width * scale,
                       view.height / 2 - shown.y * group.height * scale);
  context.drawImage(picture.canvas, 0, 0);
  return context;
}

/// A figure with what `paint` draws on and what `develop` fills.
function addFigure(place, picture, group, caption) {
  picture.figure = element('figure', null, place);
  picture.view = element('canvas', null, picture.figure);
  element('figcaption', caption, picture.figure);
  picture.canvas = document.createElement('canvas');
  picture.canvas.width = group.width;
  picture.canvas.height = group.height;
}

function eachPicture(action) {
  const scene = pictureData[viewer.scene];
  scene.pictures.forEach((picture, i) => action(picture, scene, i));
}

function repaint() {
  document.getElementById('pictures').classList.toggle('flip', viewer.flip);
  eachPicture((p, scene, i) => p.figure.classList.toggle('shown', i === viewer.shown));
  eachPicture((p, scene) => {
    const context = paint(p, scene, viewer);
    if (context && p.method < 0 && !viewer.flip) frameCrops(context, scene);
  });
  paintCrops();
  paintPyramid();
}

function redevelop() {
  document.getElementById('error-scale').classList.toggle('on', viewer.error);
  document.getElementById('exposure').value = viewer.exposure;
  document.getElementById('exposure-text').textContent = viewer.exposure.toFixed(2) + ' stops';
  eachPicture((p, scene) => develop(p, scene, viewer.error));
  developCrops();
  developPyramid();
  repaint();
}

function errorsText(errors) {
  return study.measures.map(m =>
    `${m}\u00a0${errors[m] === null ? 'not finite' : +(+errors[m]).toPrecision(3)}`).join(', ');
}

function captionOf(picture) {
  if (picture.method < 0) return 'reference: ' + study.scenes[viewer.scene].reference.origin;
  const run = study.runs.find(r => r.scene === viewer.scene && r.method === picture.method &&
                                   r.seed === picture.seed);
  return `${picture.name}: ${run.iterations} iteration${run.iterations > 1 ? 's' : ''}, ` +
      `${run.seconds.toPrecision(3)}\u00a0s (setup ${run.setup_seconds.toPrecision(2)}\u00a0s), ` +
      errorsText(run.error);
}

function showPictures(index) {
  viewer.scene = index;
  const scene = pictureData[index];
  viewer.shown = Math.min(viewer.shown, scene.pictures.length - 1);
  const place = document.getElementById('pictures');
  place.replaceChildren();
  document.getElementById('picture-note').textContent =
    `Seed ${study.seeds[0]}.` + (scene.shrink > 1 ? ` Shown at 1/${scene.shrink} of their size: ` +
    'errors here are those of averages and look smaller than they are.' : '');
  eachPicture((picture, _, i) => {
    addFigure(place, picture, scene, `${i + 1}. ${captionOf(picture)}`);
    addMouse(picture.view);
  });
  showCrops();
  showPyramids();
  redevelop();
}

function zoomBy(factor, view, clientX, clientY) {
  const box = view.getBoundingClientRect();
  // What is under the pointer stays there.
  const u = (clientX - box.left) / box.width - 0.5, v = (clientY - box.top) / box.height - 0.5;
  const zoom = Math.min(Math.max(viewer.zoom * factor, 1), 64);
  viewer.x += u / viewer.zoom - u / zoom;
  viewer.y += v / viewer.zoom - v / zoom;
  viewer.zoom = zoom;
  repaint();
}

function addMouse(view) {
  view.addEventListener('wheel', event => {
    event.preventDefault();
    zoomBy(2 ** (-event.deltaY / 240), view, event.clientX, event.clientY);
  }, {passive: false});
  view.addEventListener('pointerdown', event => {
    const box = view.getBoundingClientRect();
    let last = event;
    const move = now => {
      viewer.x -= (now.clientX - last.clientX) / box.width / viewer.zoom;
      viewer.y -= (now.clientY - last.clientY) / box.height / viewer.zoom;
      last = now;
      repaint();
    };
    const end = () => {
      removeEventListener('pointermove', move);
      removeEventListener('pointerup', end);
    };
    addEventListener('pointermove', move);
    addEventListener('pointerup', end);
  });
}

function flipTo(index) {
  const count = pictureData[viewer.scene].pictures.length;
  viewer.shown = (index + count) % count;
  viewer.flip = true;
  repaint();
}

function expose(stops) {
  viewer.exposure = stops;
  redevelop();
}

const kActions = {
  f: () => { viewer.flip = !viewer.flip; repaint(); },
  e: () => { viewer.error = !viewer.error; redevelop(); },
  0: () => { Object.assign(viewer, {zoom: 1, x: 0.5, y: 0.5}); expose(0); },
  '+': () => expose(viewer.exposure + 0.5),
  '-': () => expose(viewer.exposure - 0.5),
  ArrowRight: () => flipTo(viewer.shown + 1),
  ArrowLeft: () => flipTo(viewer.shown - 1),
};

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.target.closest && event.target.closest('input[type=range], select')) return;
  const action = kActions[event.key];
  if (action) {
    action();
  } else if (/^[1-9]$/.test(event.key) &&
             event.key <= pictureData[viewer.scene].pictures.length) {
    flipTo(event.key - 1);
  } else {
    return;
  }
  event.preventDefault();
}

function showErrorScale() {
  const {low, high, colours} = study.error_map;
  const place = document.getElementById('error-scale');
  const canvas = element('canvas', null, place);
  canvas.width = colours.length;
  canvas.height = 1;
  colours.forEach((colour, i) => {
    const context = canvas.getContext('2d');
    context.fillStyle = `rgb(${colour})`;
    context.fillRect(i, 0, 1, 1);
  });
  const marks = element('div', null, place);
  const decades = Math.round(Math.log10(high / low));
  for (let d = 0; d <= decades; ++d) element('span', String(+(low * 10 ** d).toPrecision(1)), marks);
  element('span', '|picture - reference| / (reference + a hundredth of its mean), mean of the ' +
    'channels', place, 'hint');
}
