// Words of charts that lie upon each other, or beyond the edge of their chart, as texts.
[...document.querySelectorAll('.chart')].flatMap(chart => {
    const id = chart.closest('figure').id, edge = chart.getBoundingClientRect();
    const texts = [...chart.querySelectorAll('svg text')].filter(text => text.textContent.trim());
    // The corners of words, however they are turned; letters are not as high as their lines.
    const words = texts.map(text => {
        const {x, y, width, height} = text.getBBox(), {a, b, c, d, e, f} = text.getScreenCTM();
        const corners = [[x, y + 0.25 * height], [x + width, y + 0.25 * height],
            [x + width, y + 0.8 * height], [x, y + 0.8 * height]];
        return [text.textContent, corners.map(([x, y]) => [a * x + c * y + e, b * x + d * y + f])];
    });
    // Two boxes are apart if a side of one box has the other box completely on its outer side.
    const beyond = (one, other) => one.some(([x, y], index) => {
        const [nextX, nextY] = one[(index + 1) % 4];
        const outward = [nextY - y, x - nextX];
        return other.every(([u, v]) => (u - x) * outward[0] + (v - y) * outward[1] >= 0);
    });
    const found = [];
    words.forEach(([text, corners], index) => {
        if (corners.some(([x, y]) => x < edge.left - 1 || x > edge.right + 1 || y < edge.top - 1
            || y > edge.bottom + 1)) found.push(`${id}: ${text} beyond the edge`);
        for (const [other, others] of words.slice(index + 1)) {
            if (!beyond(corners, others) && !beyond(others, corners)) found.push(`${id}: ${text} upon ${other}`);
        }
    });
    return found;
})
