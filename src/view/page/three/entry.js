// What src/view/page/page.js uses of three.js; scripts/three makes three.min.js of it.
export {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry,
  InstancedInterleavedBuffer, InterleavedBufferAttribute, LinearFilter, LineSegments, Mesh, PerspectiveCamera,
  RGBAFormat, Scene, ShaderMaterial, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
