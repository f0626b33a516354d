// The crops: parts of the pictures enlarged, side by side, with the errors inside each.

/// Calls back with every picture of every crop of the scene.
function eachCropPicture(action) {
  for (const crop of pictureData[viewer.scene].crops) {
    crop.pictures.forEach(picture => action(picture, crop));
  }
}

function showCrops() {
  const crops = pictureData[viewer.scene].crops;
  document.getElementById('crops').hidden = crops.length === 0;
  const place = document.getElementById('crop-rows');
  place.replaceChildren();
  for (const crop of crops) {
    const [x, y, width, height] = crop.rect;
    element('h4', `${crop.name}: ${width} x ${height} pixels at (${x}, ${y})` +
      (crop.shrink > 1 ? `, shown at 1/${crop.shrink} of their size` : ''), place);
    const row = element('div', null, place, 'crop-row');
    for (const picture of crop.pictures) {
      addFigure(row, picture, crop, picture.method < 0 ? picture.name
        : `${picture.name}\n${errorsText(picture.errors)}`);
    }
  }
}

function developCrops() {
  eachCropPicture((picture, crop) => develop(picture, crop, viewer.error));
}

function paintCrops() {
  eachCropPicture((picture, crop) => paint(picture, crop, kWholePicture));
}

/// Where the crops are in a picture of the whole, their names above. `context`: see paint.
function frameCrops(context, scene) {
  const scale = context.getTransform().a / devicePixelRatio;  // screen pixels
  context.font = `bold ${12 / scale}px sans-serif`;
  context.lineJoin = 'round';
  for (const crop of scene.crops) {
    const [x, y, width, height] = crop.rect.map(v => v / scene.shrink);
    context.lineWidth = 1.5 / scale;
    context.strokeStyle = '#ffd400';
    context.strokeRect(x, y, width, height);
    const top = y > 16 / scale ? y - 4 / scale : y + height + 13 / scale;
    context.lineWidth = 4 / scale;
    context.strokeStyle = '#000';
    context.fillStyle = '#ffd400';
    context.strokeText(crop.name, x, top);
    context.fillText(crop.name, x, top);
  }
}
