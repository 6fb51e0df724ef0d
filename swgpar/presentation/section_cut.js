"use strict";
// Where a plane cuts hexahedra: six tetrahedra each, around the diagonal of corners 0 and 6.
const TETRAHEDRA = [
  [0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6],
];

// Corners of the triangles in the plane: corner k lies on the edge between the nodes ends[2 k] and
// ends[2 k + 1], at share[k] of it.
// cells: eight nodes each, of one sector; stride: nodes of a sector
// distance: of all nodes from the plane
function cutCells(cells, sectors, stride, distance) {
  const ends = [], share = [], corner = new Array(8), inside = [], outside = [];
  const put = (a, b) => { ends.push(a, b); share.push(distance[a] / (distance[a] - distance[b])); };
  for (let sector = 0; sector < sectors; sector++) for (let c = 0; c < cells.length; c += 8) {
    let above = 0;
    for (let i = 0; i < 8; i++) {
      corner[i] = cells[c + i] + sector * stride;
      if (distance[corner[i]] > 0) above++;
    }
    if (above === 0 || above === 8) continue;
    for (const tetrahedron of TETRAHEDRA) {
      inside.length = outside.length = 0;
      for (const i of tetrahedron) (distance[corner[i]] > 0 ? inside : outside).push(corner[i]);
      if (inside.length === 2) {
        const [a, b] = inside, [p, q] = outside;
        put(a, p); put(a, q); put(b, q);
        put(a, p); put(b, q); put(b, p);
      } else if (inside.length && outside.length) {
        const [[a], others] = inside.length === 1 ? [inside, outside] : [outside, inside];
        for (const b of others) put(a, b);
      }
    }
  }
  return { ends, share };
}
