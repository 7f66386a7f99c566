export {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DataTexture, DirectionalLight, DoubleSide, LineBasicMaterial,
  LineLoop, LineSegments, LinearMipmapLinearFilter, Mesh, MeshLambertMaterial, NearestFilter, PerspectiveCamera, Plane, RepeatWrapping,
  SRGBColorSpace, Scene, Vector3, WebGLRenderer,
} from "three";
