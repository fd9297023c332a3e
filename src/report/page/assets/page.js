// Draws the figures of the page with Apache ECharts and handles pointer and keyboard.
(function () {
  'use strict';
  const data = JSON.parse(document.getElementById('data').textContent);
  const TAU = 2 * Math.PI;

  // ---- packed columns -------------------------------------------------------------------------
  function bytes(text) {
    const raw = atob(text);
    const out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
    return new DataView(out.buffer);
  }
  function column(packed) {
    if (Array.isArray(packed)) return packed.map((v) => (v === null ? NaN : v));
    const kind = ['f', 'u', 'w', 'b'].find((one) => one in packed);
    const view = bytes(packed[kind]);
    const size = { w: 2, b: 1 }[kind] || 4;
    const out = new Array(view.byteLength / size);
    for (let i = 0; i < out.length; i++) {
      if (kind === 'f') out[i] = view.getFloat32(4 * i, true);
      else if (kind === 'u') out[i] = view.getUint32(4 * i, true);
      else {
        const [step, last] = kind === 'w' ? [view.getUint16(2 * i, true), 65534] : [view.getUint8(i), 254];
        out[i] = step > last ? NaN : packed.from + (step / last) * (packed.to - packed.from);
      }
    }
    return out;
  }
  function pairs(packed) {
    const flat = column(packed);
    const out = [];
    for (let i = 0; i + 1 < flat.length; i += 2) out.push([flat[i], flat[i + 1]]);
    return out;
  }
  function unpack(layer) {
    if (layer.ready) return layer;
    if (layer.points) layer.points = pairs(layer.points);
    for (const key of ['x', 'y', 'low', 'high', 'edges', 'values']) {
      if (layer[key]) layer[key] = column(layer[key]);
    }
    if (layer.tooltips) {
      layer.tooltips.run_ids = column(layer.tooltips.run_ids);
      for (const one of layer.tooltips.columns) if (one.values) one.values = column(one.values);
    }
    layer.ready = true;
    return layer;
  }

  // ---- colours, numbers, symbols ---------------------------------------------------------------
  let theme = null;
  function readTheme() {
    const style = getComputedStyle(document.documentElement);
    const one = (name) => style.getPropertyValue('--' + name).trim();
    theme = { ground: one('ground'), ink: one('ink'), soft: one('soft'), line: one('line'), raised: one('raised') };
    for (const label of ['equilibrium', 'limit-cycle', 'creep', 'quasi-periodic', 'irregular', 'undecided', 'failed']) {
      theme[label.replace('-', '_')] = one(label);
    }
    theme.series = one('series').split(/\s+/);
    theme.scale = one('scale').split(/\s+/);
  }
  function mix(a, b, part) {
    const of = (colour, at) => parseInt(colour.slice(1 + 2 * at, 3 + 2 * at), 16);
    const each = [0, 1, 2].map((at) => Math.round(of(a, at) + (of(b, at) - of(a, at)) * part));
    return 'rgb(' + each.join(',') + ')';
  }
  function scaled(value, scale) {
    const [from, to] = scale.range;
    const last = theme.scale.length - 1;
    const at = Math.min(Math.max((value - from) / (to - from || 1), 0), 1) * last;
    const low = Math.min(Math.floor(at), last - 1);
    return mix(theme.scale[low], theme.scale[low + 1], at - low);
  }
  function colourOf(colour) {
    if (typeof colour === 'object') return theme.series[colour.series % theme.series.length];
    if (colour === 'ink') return theme.ink;
    if (colour === 'faint') return theme.soft;
    return theme[colour] || theme.ink;
  }
  // Dashes distinguish lines without colour.
  const DASHES = [[], [8, 4], [2, 3], [9, 3, 2, 3], [14, 4], [4, 2]];
  function dashOf(layer) {
    if (layer.dashed) return DASHES[1];
    return typeof layer.colour === 'object' ? DASHES[layer.colour.series % DASHES.length] : DASHES[0];
  }
  function lineStyle(colour, layer) {
    const dash = dashOf(layer);
    return { color: colour, width: 2, type: dash.length ? dash : 'solid' };
  }
  function number(value, digits) {
    if (value === null || value === undefined || !isFinite(value)) return '–';
    if (Number.isInteger(value) && Math.abs(value) < 1e15) return String(value).replace('-', '−');
    const size = Math.abs(value);
    const text = size !== 0 && (size < 1e-3 || size >= 1e6)
      ? value.toExponential((digits || 5) - 1).replace(/\.?0+e/, 'e') : String(Number(value.toPrecision(digits || 5)));
    return text.replace(/-/g, '−');
  }
  const PI = ['0', 'π/2', 'π', '3π/2', '2π'];
  const SYMBOLS = {
    dot: ['circle', 3.5], disc: ['circle', 8], circle: ['emptyCircle', 9], diamond: ['diamond', 10],
    triangle: ['triangle', 9], square: ['rect', 7],
    star: ['path://M0,-10L2.4,-3.2L9.5,-3.1L3.8,1.2L5.9,8.1L0,4L-5.9,8.1L-3.8,1.2L-9.5,-3.1L-2.4,-3.2Z', 15],
    cross: ['path://M-1.6,-8H1.6V-1.6H8V1.6H1.6V8H-1.6V1.6H-8V-1.6H-1.6Z', 9],
  };
  function escaped(text) {
    return String(text).replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);
  }

  // ---- data of a dot ---------------------------------------------------------------------------
  function rows(panel, layer, index) {
    const list = [];
    const tooltips = layer.tooltips;
    if (layer.mark === 'dots' || layer.mark === 'bars') {
      for (const [axis, value] of [[panel.x, layer.x[index]], [panel.y, layer.y[index]]]) {
        if (axis.kind === 'names') list.push(['', axis.names[Math.round(value)] || '']);
        else list.push([axis.name + (axis.unit ? ' [' + axis.unit + ']' : ''), number(value, axis.kind === 'angle' ? 5 : 6)]);
      }
    }
    for (const one of tooltips ? tooltips.columns : []) {
      list.push([one.name, one.words ? one.words[index] : number(one.values[index])]);
    }
    return list;
  }
  function command(layer, index) {
    const ids = layer.tooltips ? layer.tooltips.run_ids : [];
    return ids.length > index ? 'stickslip replay ' + data.directory + ' ' + ids[index] : null;
  }
  function heading(layer, index) {
    const ids = layer.tooltips ? layer.tooltips.run_ids : [];
    return [layer.name, ids.length > index ? 'run ' + ids[index] : ''].filter(Boolean).join(', ');
  }
  function tip(panel, layer, index) {
    const lines = rows(panel, layer, index)
      .map(([name, value]) => '<tr><th class="text">' + escaped(name) + '</th><td>' + escaped(value) + '</td></tr>');
    const replay = command(layer, index);
    return '<div class="tip"><strong>' + escaped(heading(layer, index)) + '</strong><table>' + lines.join('') +
      '</table>' + (replay ? '<code>' + escaped(replay) + '</code>' : '') + '</div>';
  }

  // Whether the names of an axis are slanted, because they are many or long.
  function slanted(axis) {
    if (axis.kind !== 'names') return false;
    // Each name has the width of an axis divided by their number and one; a narrow page has room for 26 characters.
    const longest = Math.max(...axis.names.map((name) => name.length));
    return axis.names.length > 5 || longest * (axis.names.length + 1) > 26;
  }

  // ---- a panel as options of the library ---------------------------------------------------------
  // Two angles, or a plane of two axes with the same unit and ends.
  function isSquare({ x, y }) {
    const same = x.unit && x.unit === y.unit && x.range && y.range && x.range.join() === y.range.join();
    return (x.kind === 'angle' && y.kind === 'angle') || Boolean(same);
  }

  function axisOf(axis, vertical, square) {
    const named = axis.kind === 'names';
    const title = axis.name + (axis.unit ? ' [' + axis.unit + ']' : '');
    const option = {
      type: axis.kind === 'logarithmic' ? 'log' : 'value',
      name: title, nameLocation: 'middle', nameGap: vertical ? 52 : 30,
      nameTextStyle: { color: theme.ink, fontSize: 14 },
      scale: true, axisLine: { show: true, onZero: false, lineStyle: { color: theme.soft } },
      axisTick: { show: true }, splitLine: { show: !square, lineStyle: { color: theme.line, opacity: 0.6 } },
      axisLabel: { color: theme.ink, fontSize: 13, hideOverlap: true, formatter: (v) => number(v, 6) },
    };
    if (axis.range) {
      [option.min, option.max] = axis.range;
      // Labels at the ends are shown only if they are round numbers on the scale of the axis.
      const step = Math.pow(10, Math.floor(Math.log10((option.max - option.min) / 2)));
      const round = (end) => axis.kind !== 'linear' || Math.abs(end / step - Math.round(end / step)) < 1e-6;
      option.axisLabel.showMinLabel = round(option.min);
      option.axisLabel.showMaxLabel = round(option.max);
    }
    if (axis.kind === 'angle') {
      option.interval = TAU / 4;
      option.axisLabel.formatter = (v) => {
        const quarter = v / (TAU / 4);
        return Math.abs(quarter - Math.round(quarter)) < 1e-6 && PI[Math.round(quarter)] || number(v, 4);
      };
    }
    if (named) {
      // Names are at whole numbers; of many names, every second, third and so on is shown.
      const every = Math.ceil(axis.names.length / 30);
      option.min = -1; option.max = axis.names.length; option.interval = 1;
      option.splitLine.show = false; option.axisTick.show = false;
      option.axisLabel.formatter = (v) => (Number.isInteger(v) && v % every === 0 ? axis.names[v] || '' : '');
      option.axisLabel.hideOverlap = false;
      option.axisLabel.rotate = slanted(axis) ? 30 : 0;
      option.nameGap = slanted(axis) ? 76 : 30;
    }
    return option;
  }
  function stepped(x, low, high) {
    const lower = [], upper = [];
    for (let i = 0; i < x.length; i++) {
      if (i > 0) { lower.push([x[i], low[i - 1]]); upper.push([x[i], high[i - 1]]); }
      lower.push([x[i], low[i]]); upper.push([x[i], high[i]]);
    }
    return lower.concat(upper.reverse());
  }
  function outline(layer) {
    const { x, low, high } = layer;
    if (layer.steps) return stepped(x, low, high);
    const lower = x.map((v, i) => [v, low[i]]);
    return lower.concat(x.map((v, i) => [v, high[i]]).reverse());
  }
  // The colour bar of a scale with the values at its ends, at a position of a saved figure in pixels.
  function bar(scale, x, y, height) {
    const [from, to] = scale.range;
    const parts = 60;
    const text = (value, at) => ({ type: 'text', x: x + 24, y: at, style: { text: number(value, 3), fill: theme.ink, fontSize: 13, verticalAlign: 'middle' } });
    const children = Array.from({ length: parts }, (_, k) => ({ type: 'rect',
      shape: { x, y: y + height * (1 - (k + 1) / parts), width: 18, height: height / parts + 0.5 },
      style: { fill: scaled(from + (to - from) * (k + 0.5) / parts, scale) } }));
    children.push(text(to, y), text((from + to) / 2, y + height / 2), text(from, y + height),
      { type: 'text', x, y: y - 20, style: { text: scale.name, fill: theme.ink, fontSize: 13, verticalAlign: 'middle' } });
    return { type: 'custom', silent: true, clip: false, data: [[0]], encode: { x: -1, y: -1 }, renderItem: () => ({ type: 'group', children }) };
  }
  // Draws values on a grid as an image, in the colours of a scale.
  function raster(layer, scale, aspect) {
    const [columns, rows] = layer.size;
    const canvas = Object.assign(document.createElement('canvas'), { width: columns, height: rows });
    const context = canvas.getContext('2d');
    layer.values.forEach((value, i) => {
      if (!isFinite(value)) return;
      context.fillStyle = scaled(value, scale);
      context.fillRect(i % columns, rows - 1 - Math.floor(i / columns), 1, 1);
    });
    // Drawn in the aspect ratio of the panel, because SVG keeps that of an image.
    const shown = Object.assign(document.createElement('canvas'), { width: 4 * columns, height: Math.round(4 * columns / aspect) });
    const onto = shown.getContext('2d');
    onto.imageSmoothingEnabled = false;
    onto.drawImage(canvas, 0, 0, shown.width, shown.height);
    return shown;
  }
  function seriesOf(panel, layer, order) {
    unpack(layer);
    const colour = colourOf(layer.colour);
    const base = { id: String(order), name: layer.name, z: 2 + order, animation: false, clip: true };
    switch (layer.mark) {
      case 'line':
        return Object.assign(base, { type: 'line', data: layer.points, showSymbol: false, silent: true,
          lineStyle: lineStyle(colour, layer) });
      case 'steps':
        return Object.assign(base, { type: 'line', step: 'end', data: layer.points, showSymbol: false, silent: true,
          lineStyle: lineStyle(colour, layer) });
      case 'band':
        return Object.assign(base, { type: 'custom', silent: true, data: [[0]], encode: { x: -1, y: -1 },
          renderItem: (params, api) => ({ type: 'polygon',
            shape: { points: outline(layer).map((p) => api.coord(p)) }, style: { fill: colour, opacity: 0.15 } }) });
      case 'raster':
        return Object.assign(base, { type: 'custom', silent: true, data: [[0]], encode: { x: -1, y: -1 },
          renderItem: (params, api) => {
            const a = api.coord([panel.x.range[0], panel.y.range[1]]);
            const b = api.coord([panel.x.range[1], panel.y.range[0]]);
            return { type: 'image', style: { image: raster(layer, panel.scale, (b[0] - a[0]) / (b[1] - a[1])),
              x: a[0], y: a[1], width: b[0] - a[0], height: b[1] - a[1] } };
          } });
      case 'intervals':
        return Object.assign(base, { type: 'custom', silent: true,
          data: layer.x.map((x, i) => [x, layer.low[i], layer.high[i]]),
          encode: { x: 0, y: [1, 2] },
          renderItem: (params, api) => {
            const low = api.coord([api.value(0), api.value(1)]);
            const high = api.coord([api.value(0), api.value(2)]);
            const stroke = { stroke: colour, lineWidth: 1.6, fill: 'none' };
            const line = (x1, y1, x2, y2) => ({ type: 'line', shape: { x1, y1, x2, y2 }, style: stroke });
            return { type: 'group', children: [
              line(low[0], low[1], high[0], high[1]),
              line(low[0] - 4, low[1], low[0] + 4, low[1]),
              line(high[0] - 4, high[1], high[0] + 4, high[1]),
            ] };
          } });
      case 'cells':
        return Object.assign(base, { type: 'custom', data: layer.values.map((v, i) =>
          [layer.edges[4 * i], layer.edges[4 * i + 1], layer.edges[4 * i + 2], layer.edges[4 * i + 3], v]),
          encode: { x: [0, 1], y: [2, 3] },
          renderItem: (params, api) => {
            const a = api.coord([api.value(0), api.value(2)]);
            const b = api.coord([api.value(1), api.value(3)]);
            const value = layer.values[params.dataIndex];
            const shown = isFinite(value);
            return { type: 'rect',
              shape: { x: a[0], y: b[1], width: b[0] - a[0] + 0.5, height: a[1] - b[1] + 0.5 },
              style: { fill: shown ? scaled(value, panel.scale) : theme.ground, stroke: shown ? 'none' : theme.line } };
          },
          tooltip: { formatter: (at) => tip(panel, layer, at.dataIndex) } });
      case 'bars':
        return Object.assign(base, { type: 'custom', data: layer.x.map((x, i) => [x, layer.y[i]]), encode: { x: 0, y: 1 },
          renderItem: (params, api) => {
            const a = api.coord([api.value(0) - layer.width / 2, 0]);
            const b = api.coord([api.value(0) + layer.width / 2, api.value(1)]);
            return { type: 'rect', shape: { x: a[0], y: Math.min(a[1], b[1]), width: b[0] - a[0], height: Math.abs(a[1] - b[1]) },
              style: { fill: colour } };
          },
          tooltip: { formatter: (at) => tip(panel, layer, at.dataIndex) } });
      case 'rule':
        return Object.assign(base, { type: 'line', data: [], silent: true, markLine: {
          silent: true, symbol: 'none', animation: false,
          lineStyle: { color: colour, type: 'dashed', width: 1.5 },
          label: { formatter: layer.label, color: theme.ink, position: layer.upright ? 'end' : 'insideEndTop', fontSize: 13 },
          data: [layer.upright ? { xAxis: layer.at } : { yAxis: layer.at }] } });
      case 'dots': {
        const [symbol, size] = SYMBOLS[layer.symbol];
        const many = layer.x.length > 3000;
        const open = symbol === 'emptyCircle';
        return Object.assign(base, { type: 'scatter', symbol: open ? 'circle' : symbol,
          // A few dots are drawn larger.
          symbolSize: layer.symbol !== 'dot' ? (many ? Math.min(size, 4) : size)
            : layer.x.length > 20000 ? 2.2 : layer.x.length < 100 ? 6 : size,
          large: many, largeThreshold: 3000, progressive: 0,
          data: layer.x.map((x, i) => [x, layer.y[i]]),
          itemStyle: open ? { color: theme.ground, borderColor: colour, borderWidth: 2 }
            : { color: colour, opacity: layer.symbol !== 'dot' ? 1 : layer.x.length > 20000 ? 0.4 : 0.8,
                borderColor: layer.symbol === 'star' ? theme.ground : undefined, borderWidth: layer.symbol === 'star' ? 1 : 0 },
          tooltip: { formatter: (at) => tip(panel, layer, at.dataIndex) } });
      }
    }
    return base;
  }

  // The ordinate of a curve at an abscissa; steps stay at a value until the next point.
  function reading(layer, x) {
    const points = layer.points;
    let low = 0, high = points.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (points[middle][0] <= x) low = middle + 1; else high = middle;
    }
    if (low === 0) return layer.mark === 'steps' ? 0 : NaN;
    const before = points[low - 1];
    if (layer.mark === 'steps' || low === points.length) return before[1];
    const after = points[low];
    return before[1] + ((x - before[0]) / (after[0] - before[0])) * (after[1] - before[1]);
  }

  // ---- a figure on the page ------------------------------------------------------------------------
  class Figure {
    constructor(spec) {
      this.spec = spec;
      this.element = document.getElementById(spec.id);
      this.chart = null;
      this.hidden = new Set();
      // The panel with the most series is shown first.
      const has = (layer) => layer.name && !(layer.mark === 'dots' && Array.isArray(layer.x) && !layer.x.length);
      const rich = (panel) => new Set(panel.layers.filter(has).map((layer) => layer.name)).size;
      const first = spec.panels.reduce((best, panel) => (rich(panel) > rich(best) ? panel : best));
      this.title = first.title;
      this.part = first.part;
      this.at = -1;
      this.build();
    }
    panel() {
      const found = this.spec.panels.find((p) => p.title === this.title && p.part === this.part);
      return found || this.spec.panels.find((p) => p.title === this.title) || this.spec.panels[0];
    }
    select(text, key) {
      const values = [...new Set(this.spec.panels.map((p) => p[key]))];
      if (values.length < 2) {
        // A single value is shown as text.
        if (values[0]) this.controls.append(Object.assign(document.createElement('span'), { textContent: values[0] }));
        return;
      }
      const label = document.createElement('label');
      label.textContent = text;
      const select = document.createElement('select');
      for (const value of values) {
        const option = document.createElement('option');
        option.value = option.textContent = value;
        option.selected = value === this[key];
        select.append(option);
      }
      select.addEventListener('change', () => { this[key] = select.value; this.zoomed = null; this.draw(); });
      label.append(select);
      this.controls.append(label);
    }
    button(text, name, action) {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = text;
      button.setAttribute('aria-label', name);
      button.title = name;
      button.addEventListener('click', action);
      this.zoom.append(button);
    }
    build() {
      const make = (tag, name) => { const e = document.createElement(tag); e.className = name; return e; };
      this.controls = make('div', 'controls');
      this.legend = make('div', 'legend');
      this.legend.setAttribute('role', 'group');
      this.legend.setAttribute('aria-label', 'Series: press to hide or show');
      const side = make('div', 'side');
      this.box = make('div', 'chart');
      this.box.tabIndex = 0;
      // In the role `img` a screen reader would not pass on arrow keys.
      this.box.setAttribute('role', 'application');
      this.box.setAttribute('aria-roledescription', 'chart');
      this.box.setAttribute('aria-label', this.spec.title + '. Arrow keys move from dot to dot, Escape closes the tooltip.');
      this.box.setAttribute('aria-describedby', this.spec.id + '-words');
      this.scale = make('div', 'scale');
      side.append(this.box, this.scale);
      this.picked = make('div', 'picked');
      this.picked.setAttribute('role', 'status');
      this.zoom = make('div', 'zoom');
      this.button('+', 'Zoom in', () => this.zoomBy(0.5));
      this.button('−', 'Zoom out', () => this.zoomBy(2));
      this.button('all', 'Show all', () => this.zoomBy(Infinity));
      this.button('SVG', 'Save this figure as SVG', () => this.save('svg'));
      this.button('PNG', 'Save this figure as PNG', () => this.save('png'));
      this.select('point', 'title');
      this.select('shown', 'part');
      this.controls.append(this.legend, this.zoom);
      const caption = this.element.querySelector('figcaption');
      this.element.insertBefore(this.controls, caption);
      this.element.insertBefore(side, caption);
      this.element.insertBefore(this.picked, caption);
      this.box.addEventListener('keydown', (event) => this.key(event));
      const square = this.spec.panels.some(isSquare);
      this.box.classList.toggle('square', square);
      // The legend is built before the figure is drawn, so that the keyboard can reach it.
      this.drawLegend(this.panel());
    }
    draw() {
      const panel = this.panel();
      // The colour bar stands beside the chart and reduces its width.
      const beside = this.scale.hidden;
      this.drawScale(panel);
      if (this.chart && this.scale.hidden !== beside) this.chart.resize();
      if (!this.chart) {
        this.chart = echarts.init(this.box, null, { renderer: this.marks() > 2500 ? 'canvas' : 'svg' });
        this.chart.on('click', (at) => this.pick(at.seriesId, at.dataIndex));
      }
      this.drawn = this.shown(panel);
      this.chart.setOption(this.option(panel), { notMerge: true });
      this.at = -1;
      const empty = this.drawn.every(({ layer }) => layer.mark === 'rule' || (layer.mark === 'dots' && !layer.x.length));
      this.picked.textContent = empty && !this.hidden.size ? 'No data in this panel.' : '';
      this.drawLegend(panel);
    }
    shown(panel) {
      return panel.layers.map((layer, order) => ({ layer, order }))
        .filter(({ layer }) => !layer.name || !this.hidden.has(layer.name));
    }
    option(panel) {
      const square = isSquare(panel);
      const bottom = slanted(panel.x) ? 104 : 56;
      // Without dots, the tooltip shows the values of the curves at the pointer's abscissa.
      const curves = panel.layers.every(({ mark }) => ['line', 'steps', 'band', 'rule'].includes(mark));
      return {
        animation: false, aria: { enabled: false },
        textStyle: { fontFamily: getComputedStyle(document.body).fontFamily, color: theme.ink },
        grid: { left: panel.x.kind === 'names' ? 96 : 72, right: 22, top: 26, bottom, containLabel: false },
        tooltip: { trigger: curves ? 'axis' : 'item', confine: true, axisPointer: { type: 'line', label: { show: false } },
          formatter: curves ? (at) => this.readings(panel, at) : undefined, backgroundColor: theme.ground, borderColor: theme.line,
          textStyle: { color: theme.ink, fontSize: 13 }, transitionDuration: 0 },
        xAxis: axisOf(panel.x, false, square), yAxis: axisOf(panel.y, true, square),
        dataZoom: [
          { id: 'x', type: 'inside', xAxisIndex: 0, filterMode: 'none', zoomOnMouseWheel: 'ctrl', moveOnMouseMove: true, preventDefaultMouseMove: false },
          { id: 'y', type: 'inside', yAxisIndex: 0, filterMode: 'none', zoomOnMouseWheel: 'ctrl', moveOnMouseMove: true, preventDefaultMouseMove: false },
        ],
        series: this.drawn.map(({ layer, order }) => seriesOf(panel, layer, order)),
      };
    }
    // Saves the panel, as zoomed, in the light theme with title, legend and colour bar.
    save(format) {
      const panel = this.panel();
      const square = isSquare(panel);
      const [width, height] = square ? [760, 710] : [900, 560];
      const zoomed = this.chart ? this.window() : [[0, 100], [0, 100]];
      document.documentElement.dataset.paper = 'true';
      readTheme();
      const chart = echarts.init(document.createElement('div'), null,
        { renderer: format === 'svg' ? 'svg' : 'canvas', devicePixelRatio: 3, width, height });
      const option = this.option(panel);
      const named = option.series.filter((series) => series.name);
      // Legend entries need the colours of their series, which custom series lack.
      const names = [...new Set(named.map((series) => series.name))];
      this.shown(panel).forEach(({ layer }, place) => {
        const series = option.series[place];
        if (series.type === 'custom') series.itemStyle = { color: colourOf(layer.colour) };
      });
      option.title = { text: this.spec.title, subtext: [panel.title, panel.part].filter(Boolean).join(', '), left: 8, top: 4,
        textStyle: { color: theme.ink, fontSize: 16 }, subtextStyle: { color: theme.soft, fontSize: 13 } };
      option.legend = { data: names, left: 8, top: 48, textStyle: { color: theme.ink, fontSize: 13 } };
      Object.assign(option.grid, { top: 96, right: panel.scale ? 130 : 30 });
      if (panel.scale) option.series.push(bar(panel.scale, width - 104, 110, height - 200));
      option.dataZoom.forEach((zoom, axis) => { [zoom.start, zoom.end] = zoomed[axis]; });
      // Quoted font names would end SVG attributes.
      option.textStyle.fontFamily = 'sans-serif';
      delete option.tooltip;
      chart.setOption(option);
      chart.getZr().flush();
      const link = document.createElement('a');
      link.href = chart.getDataURL({ type: format, pixelRatio: 3, backgroundColor: theme.ground });
      link.download = [this.spec.id, panel.title, panel.part].filter(Boolean).join(' ')
        .replace(/[^\p{L}\p{N}.−-]+/gu, '-') + '.' + format;
      chart.dispose();
      delete document.documentElement.dataset.paper;
      readTheme();
      link.click();
    }
    readings(panel, at) {
      const x = at && at.length ? at[0].axisValue : NaN;
      const lines = this.drawn.filter(({ layer }) => layer.mark === 'line' || layer.mark === 'steps')
        .map(({ layer }) => '<tr><th class="text">' + sample([layer]) + ' ' + escaped(layer.name) + '</th><td>' + number(reading(layer, x), 4) + '</td></tr>');
      return '<div class="tip"><strong>' + escaped(panel.x.name) + ' ' + number(x, 4) + ' ' + escaped(panel.x.unit) +
        '</strong><table>' + lines.join('') + '</table></div>';
    }
    marks() {
      const length = (packed) => (Array.isArray(packed) ? packed.length : packed.f ? packed.f.length / 5.34 : packed.w.length / 2.67);
      return Math.max(...this.spec.panels.map((p) => p.layers.reduce((sum, l) => sum + (l.mark === 'dots' ? length(l.x) : 0), 0)));
    }
    drawLegend(panel) {
      const names = [...new Set(panel.layers.map((layer) => layer.name).filter(Boolean))];
      const focused = this.legend.contains(document.activeElement) ? document.activeElement.dataset.name : null;
      this.legend.replaceChildren();
      for (const name of names) {
        const layers = panel.layers.filter((layer) => layer.name === name);
        const button = document.createElement('button');
        button.type = 'button';
        button.dataset.name = name;
        button.setAttribute('aria-pressed', String(!this.hidden.has(name)));
        button.innerHTML = sample(layers);
        button.append(name);
        button.addEventListener('click', () => {
          if (!this.hidden.delete(name)) this.hidden.add(name);
          const zoomed = this.window();
          this.draw();
          this.show(zoomed);
        });
        this.legend.append(button);
        if (name === focused) button.focus();
      }
    }
    drawScale(panel) {
      this.scale.hidden = !panel.scale;
      if (!panel.scale) return;
      const { name, range } = panel.scale;
      this.scale.innerHTML = '<div>' + escaped(name) + '</div><div class="bar"></div><div class="ends"><span>' +
        number(range[0], 3) + '</span><span>' + number((range[0] + range[1]) / 2, 3) + '</span><span>' + number(range[1], 3) + '</span></div>';
      this.scale.querySelector('.bar').style.background = 'linear-gradient(to right,' + theme.scale.join(',') + ')';
      this.scale.querySelector('.bar').style.setProperty('print-color-adjust', 'exact');
    }
    window() {
      const zooms = this.chart.getOption().dataZoom;
      return zooms.map((zoom) => [zoom.start, zoom.end]);
    }
    show(ends) {
      ends.forEach(([start, end], index) => {
        this.chart.dispatchAction({ type: 'dataZoom', dataZoomIndex: index, start, end });
      });
    }
    zoomBy(factor) {
      this.show(this.window().map(([start, end]) => {
        const middle = (start + end) / 2;
        const half = Math.min(50, ((end - start) / 2) * factor);
        const low = Math.min(Math.max(0, middle - half), 100 - 2 * half);
        return factor === Infinity ? [0, 100] : [low, low + 2 * half];
      }));
    }
    layer(order) { return this.panel().layers[Number(order)]; }
    pick(order, index) {
      const panel = this.panel();
      const layer = this.layer(order);
      if (!layer || !layer.tooltips) return;
      const said = rows(panel, layer, index).map(([name, value]) => (name ? name + ' ' : '') + value).join(', ');
      const replay = command(layer, index);
      this.picked.textContent = heading(layer, index) + ': ' + said + ' ';
      if (!replay) return;
      const code = document.createElement('code');
      code.className = 'command';
      code.textContent = replay;
      const copy = document.createElement('button');
      copy.type = 'button';
      copy.className = 'copy';
      copy.textContent = 'copy';
      copy.setAttribute('aria-label', 'Copy the command ' + replay);
      copy.addEventListener('click', () => {
        const range = document.createRange();
        range.selectNodeContents(code);
        const selection = getSelection();
        selection.removeAllRanges();
        selection.addRange(range);
        const done = () => { copy.textContent = 'copied'; };
        if (navigator.clipboard) navigator.clipboard.writeText(replay).then(done, () => { document.execCommand('copy'); done(); });
        else { document.execCommand('copy'); done(); }
      });
      this.picked.append(code, ' ', copy);
    }
    // Moves from dot to dot, in the order of the layers.
    key(event) {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (event.key === 'Escape' && this.chart) this.chart.dispatchAction({ type: 'hideTip' });
      if (!step && event.key !== 'Home' && event.key !== 'End') return;
      const dots = this.drawn.map(({ layer, order }, place) => ({ layer, order, place }))
        .filter(({ layer }) => ['dots', 'bars', 'cells'].includes(layer.mark));
      const count = (layer) => (layer.mark === 'cells' ? layer.values.length : layer.x.length);
      const all = dots.reduce((sum, { layer }) => sum + count(layer), 0);
      if (!all) return;
      event.preventDefault();
      this.at = event.key === 'Home' ? 0 : event.key === 'End' ? all - 1 : (this.at + step + all) % all;
      if (this.at < 0) this.at = 0;
      let left = this.at;
      for (const { layer, order, place } of dots) {
        if (left < count(layer)) {
          this.chart.dispatchAction({ type: 'showTip', seriesIndex: place, dataIndex: left });
          this.pick(order, left);
          return;
        }
        left -= count(layer);
      }
    }
  }

  // Returns a sample of a series for the legend.
  function sample(layers) {
    const colour = colourOf(layers[0].colour);
    let inside = '';
    for (const layer of layers) {
      if (layer.mark === 'line' || layer.mark === 'steps') {
        const dash = dashOf(layer).join(' ');
        inside += '<path d="M1 7H23" stroke="' + colour + '" stroke-width="2" stroke-dasharray="' + dash + '"/>';
      } else if (layer.mark === 'dots') {
        const shapes = {
          dot: '<circle cx="12" cy="7" r="2.5" fill="C"/>', disc: '<circle cx="12" cy="7" r="4" fill="C"/>',
          circle: '<circle cx="12" cy="7" r="4" fill="none" stroke="C" stroke-width="2"/>',
          diamond: '<path d="M12 2L17 7L12 12L7 7Z" fill="C"/>', triangle: '<path d="M12 2L17 11H7Z" fill="C"/>',
          square: '<path d="M8 3H16V11H8Z" fill="C"/>',
          star: '<path transform="translate(12 7) scale(.7)" d="M0,-10L2.4,-3.2L9.5,-3.1L3.8,1.2L5.9,8.1L0,4L-5.9,8.1L-3.8,1.2L-9.5,-3.1L-2.4,-3.2Z" fill="C"/>',
          cross: '<path d="M11 2H13V6H17V8H13V12H11V8H7V6H11Z" fill="C"/>',
        };
        inside += shapes[layer.symbol].replace(/C"/g, colour + '"');
      } else if (layer.mark !== 'intervals' && !inside) {
        inside += '<path d="M4 2H20V12H4Z" fill="' + colour + '" opacity="' + (layer.mark === 'band' ? 0.25 : 1) + '"/>';
      }
    }
    return '<svg width="24" height="14" aria-hidden="true">' + inside + '</svg>';
  }

  // ---- the page ------------------------------------------------------------------------------------
  readTheme();
  for (const time of document.querySelectorAll('time[data-unix]')) {
    const at = new Date(1000 * Number(time.dataset.unix));
    time.dateTime = at.toISOString();
    time.textContent = at.toISOString().slice(0, 16).replace('T', ' ') + ' UTC';
  }
  const figures = data.figures.map((spec) => new Figure(spec));
  const draw = (figure) => { if (!figure.chart) figure.draw(); };
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) draw(figures.find((figure) => figure.element === entry.target));
    }
  }, { rootMargin: '600px' });
  figures.forEach((figure) => seen.observe(figure.element));
  const fit = () => {
    if (!document.documentElement.dataset.paper) figures.forEach((figure) => figure.chart && figure.chart.resize());
  };
  let waiting = 0;
  addEventListener('resize', () => { clearTimeout(waiting); waiting = setTimeout(fit, 100); });
  const again = () => { readTheme(); figures.forEach((figure) => figure.chart && figure.draw()); };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  // Print is always in the light theme, at the width of the paper.
  addEventListener('beforeprint', () => {
    document.documentElement.dataset.paper = 'true';
    readTheme();
    for (const words of document.querySelectorAll('figcaption details:not([open])')) {
      words.open = true;
      words.dataset.folded = 'true';
    }
    for (const figure of figures) {
      figure.draw();
      const square = figure.box.classList.contains('square');
      figure.chart.resize(square ? { width: 480, height: 480 } : { width: 640, height: 360 });
      // Draws immediately: no animation frame occurs before printing.
      figure.chart.getZr().flush();
    }
  });
  addEventListener('afterprint', () => {
    delete document.documentElement.dataset.paper;
    for (const words of document.querySelectorAll('details[data-folded]')) {
      words.open = false;
      delete words.dataset.folded;
    }
    again();
    for (const figure of figures) figure.chart.resize({ width: 'auto', height: 'auto' });
  });
  document.documentElement.dataset.ready = 'true';
})();
