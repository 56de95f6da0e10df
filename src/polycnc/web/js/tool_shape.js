// A tool as a body: its outline turned about its axis, shaft and holder above; an insert as a plate; else a pointer.
import { Color, DoubleSide, ExtrudeGeometry, Group, LatheGeometry, Mesh, MeshStandardMaterial, Shape, Vector2 } from "three";

const body = (points, colour, opacity = 1) => {
  const geometry = new LatheGeometry(points.map(([r, z]) => new Vector2(Math.max(r, 0), z)), 40);
  geometry.rotateX(Math.PI / 2); // the axis of a lathe geometry is y
  return meshOf(geometry, colour, opacity);
};
const meshOf = (geometry, colour, opacity) => {
  const material = new MeshStandardMaterial({ color: new Color(colour), metalness: 0.35, roughness: 0.4, side: DoubleSide, transparent: opacity < 1, opacity });
  return new Mesh(geometry, material);
};

// Of an insert: its face (X, Z) in the picture of a lathe, with Z to the right and X up, as thick as a fifth of its size.
function plateOf(corners, colour) {
  const thick = 0.2 * Math.max(...corners.map(([x]) => x)) - 0.2 * Math.min(...corners.map(([x]) => x));
  const geometry = new ExtrudeGeometry(new Shape(corners.map(([x, z]) => new Vector2(z, x))), { depth: thick, bevelEnabled: false });
  geometry.translate(0, 0, -thick / 2);
  geometry.rotateX(Math.PI / 2);
  return meshOf(geometry, colour, 1);
}

// `shape` has `outline` and `holder` (mm) where they are known; a pointer is `size` long. One that is wide beside that
// is glass, so that it does not hide what it cuts.
export function toolShape(shape, size, colour) {
  const group = new Group();
  const outline = shape?.outline;
  if (shape?.plate) { group.add(plateOf(shape.plate, colour)); return group; }
  if (!outline) {
    group.add(body([[0, 0], [0.16 * size, 0.55 * size], [0.16 * size, size], [0, size]], colour, 0.85));
    return group;
  }
  const [radius, top] = outline[outline.length - 1];
  const solid = radius > 1.2 * size ? 0.4 : 0.92;
  group.add(body([...outline, [0, top]], colour, solid));
  group.add(body([[0, top], [0.96 * radius, top], [0.96 * radius, top + 3 * radius], [0, top + 3 * radius]], "#9aa4ad", solid));
  let end = top + 3 * radius;
  for (const [height, r] of shape.holder ?? []) { group.add(body([[0, height], [r, height], [r, height + r], [0, height + r]], "#59636c", 0.65 * solid)); end = Math.max(end, height + r); }
  if (!shape.holder?.length) group.add(body([[0, end], [1.8 * radius, end], [2.1 * radius, end + 2 * radius], [0, end + 2 * radius]], "#59636c", 0.65 * solid));
  return group;
}
