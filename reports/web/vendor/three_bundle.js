// SPDX-License-Identifier: BSD-3-Clause
// What the page uses of three.js; see scripts/bundle_web.sh.
export { BufferAttribute, BufferGeometry, Color, GridHelper, Group, Mesh, MeshBasicMaterial, PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene,
  SphereGeometry, Vector3, WebGLRenderer } from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
export { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
export { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
export { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
