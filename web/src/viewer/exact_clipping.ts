import { ShaderChunk } from "three";

/** Clips faces where they are, also those that cover a corner of a pixel only.
 *
 * With several samples per pixel a fragment is asked at the middle of its pixel, where a face seen edge-on may not be: its
 * distance to the plane is then extrapolated, far, and what is cut away leaves stray pixels, and counts in sections. At the
 * centroid of what is covered it is asked within the face. */
for (const part of ["clipping_planes_pars_vertex", "clipping_planes_pars_fragment"] as const) {
  ShaderChunk[part] = ShaderChunk[part].replace("varying vec3 vClipPosition", "centroid varying vec3 vClipPosition");
}
