// The stage: a picture in three dimensions with parallel lines of sight, drawn when something has changed.
import { AmbientLight, Color, DirectionalLight, OrthographicCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "./OrbitControls.js";

const DIRECTIONS = { // from where it is seen
  "3-D": [-0.5, -0.68, 0.54], Top: [0, -1e-4, 1], Front: [0, -1, 0], Side: [1, 0, 0],
};

export class Stage {
  constructor(holder, { flat = false } = {}) {
    this.holder = holder;
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    holder.prepend(this.renderer.domElement);
    this.canvas = this.renderer.domElement;
    this.scene = new Scene();
    this.camera = new OrthographicCamera(-1, 1, 1, -1, -1, 1);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(...DIRECTIONS["3-D"]);
    this.lamp = new DirectionalLight(0xffffff, 2.2);
    this.lamp.position.set(-0.4, -0.6, 1);
    this.camera.add(new DirectionalLight(0xffffff, 0.9));
    this.scene.add(new AmbientLight(0xffffff, 1.1), this.lamp, this.camera);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.enableRotate = !flat;
    if (flat) Object.assign(this.controls, { mouseButtons: { LEFT: 2, MIDDLE: 1, RIGHT: 2 }, touches: { ONE: 1, TWO: 2 } });
    this.controls.addEventListener("change", () => this.draw());
    this.reach = 1000; // how far from the middle anything is
    this.before = []; // called before each picture
    this.waiting = false;
    new ResizeObserver(() => this.resize()).observe(holder);
    this.resize();
  }

  get width() { return Math.max(this.holder.clientWidth, 1); }
  get height() { return Math.max(this.holder.clientHeight, 1); }

  resize() {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(this.width, this.height, false);
    const half = this.camera.top;
    this.camera.left = -half * this.width / this.height;
    this.camera.right = -this.camera.left;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  paper(colour) { this.scene.background = new Color(colour); }

  // Look from a direction so that a box, [[low, high] of x, y, z], fills the stage.
  look(name, box, fill = 0.82) {
    const from = new Vector3(...DIRECTIONS[name]).normalize();
    const middle = new Vector3(...box.map(([low, high]) => (low + high) / 2));
    const right = new Vector3().crossVectors(this.camera.up, from).normalize();
    const upright = new Vector3().crossVectors(from, right);
    const across = (direction) => Math.max(direction.toArray().reduce((sum, d, i) => sum + Math.abs(d) * (box[i][1] - box[i][0]), 0), 1e-3);
    const half = 0.5 / fill * Math.max(across(upright), across(right) * this.height / this.width);
    const reach = this.reach + box.reduce((sum, [low, high]) => sum + high - low, 0);
    this.camera.top = half; this.camera.bottom = -half; this.camera.zoom = 1;
    this.camera.near = -2 * reach; this.camera.far = 4 * reach;
    this.camera.position.copy(middle).addScaledVector(from, reach);
    this.controls.target.copy(middle);
    this.resize();
    this.controls.update();
  }

  get pixel_mm() { return (this.camera.top - this.camera.bottom) / this.camera.zoom / this.height; }

  // Where a place of the scene is on the stage, in pixels of the page.
  project(place, to = new Vector3()) {
    to.copy(place).project(this.camera);
    return to.set((to.x + 1) / 2 * this.width, (1 - to.y) / 2 * this.height, to.z);
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.render());
  }

  render() {
    this.waiting = false;
    this.camera.updateMatrixWorld(); // for what is projected before the picture
    for (const call of this.before) call();
    this.renderer.render(this.scene, this.camera);
  }
}

export const directions = Object.keys(DIRECTIONS);
