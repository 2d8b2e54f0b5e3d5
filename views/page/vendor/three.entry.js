// What page/scene.js takes of three.js; update-vendor bundles it as the global THREE.
export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, FrontSide, GLSL3, LinearFilter, ClampToEdgeWrapping,
  LineBasicMaterial, LineSegments, Matrix4, Mesh, NearestFilter, OrthographicCamera, Quaternion, RGBAFormat, Scene,
  ShaderMaterial, UnsignedByteType, Vector2, Vector3, Vector4, WebGLRenderer
} from "three";
