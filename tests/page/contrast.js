// The contrast of all text that is seen to what is behind it (WCAG 2.2, relative luminance), as
// [{text, ratio}]. Colours are asked of a canvas, which knows all notations.
(() => {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 1;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  const known = new Map();
  // Red, green, blue, from 0 to 255, and opacity from 0 to 1.
  const parsed = colour => {
    if (!known.has(colour)) {
      context.clearRect(0, 0, 1, 1);
      context.fillStyle = colour;
      context.fillRect(0, 0, 1, 1);
      const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
      known.set(colour, [r, g, b, a / 255]);
    }
    return known.get(colour);
  };
  const over = ([r, g, b, a], under) => [r, g, b].map((value, k) => value * a + under[k] * (1 - a));
  const luminance = colour => {
    const [r, g, b] = colour.map(value => {
      const part = value / 255;
      return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  // What is behind the text of an element, and how much of its own colour reaches the eye.
  const paper = element => {
    const layers = [];
    let opacity = 1;
    for (let at = element; at; at = at.parentElement) {
      const style = getComputedStyle(at);
      opacity *= Number(style.opacity);
      layers.push(parsed(style.backgroundColor));
    }
    // The canvas that a page is painted on.
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const scheme = getComputedStyle(document.documentElement).colorScheme;
    const base = dark && scheme.includes("dark") ? [18, 18, 18] : [255, 255, 255];
    return {behind: layers.reverse().reduce((under, layer) => over(layer, under), base), opacity};
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, element = node.parentElement;
    const text = node.textContent.trim();
    if (!text || element.closest("script, style, title, desc")) continue;
    if (!element.checkVisibility({visibilityProperty: true, opacityProperty: true})) continue;
    const style = getComputedStyle(element);
    const ink = element instanceof SVGElement ? style.fill : style.color;
    if (ink === "none") continue;
    const {behind, opacity} = paper(element);
    const [r, g, b, a] = parsed(ink);
    const front = over([r, g, b, a * opacity], behind);
    const [dark, light] = [luminance(front), luminance(behind)].sort((one, other) => one - other);
    found.push({text: text.slice(0, 60), ratio: (light + 0.05) / (dark + 0.05)});
  }
  return found;
})()
