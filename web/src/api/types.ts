/** What the server answers with, as far as the page looks at it; the whole contract is openapi/openapi.json. */

export type Severity = "error" | "warning" | "info";
export type Unit = "m" | "cm" | "mm" | "in";
export type Vector = [number, number, number];
export type JobStatus = "accepted" | "running" | "successful" | "failed" | "dismissed";
export type Verdict = "simulation_ready" | "not_ready";

export interface Place {
  mesh: string;
  point_mm: Vector;
}

export interface Finding {
  code: string;
  severity: Severity;
  message: string;
  count: number;
  places: Place[];
}

export interface Problem {
  code: string;
  status: number;
  title: string;
  detail: string;
  retryable: boolean;
  request_id: string;
  errors?: { location?: string; path?: string; pointer?: string; message?: string; detail?: string }[];
  findings?: Finding[];
}

export interface VertexArray {
  name: string;
  minimum?: number;
  maximum?: number;
}

export interface VolumeInfo {
  voxels: Vector;
  voxel_mm: Vector;
  labels: { label: number; voxels: number; volume_mm3: number }[];
}

export interface FieldInfo {
  numbers: number;
  columns: string[];
  data: { name: string }[];
}

export interface CoilInfo {
  dipoles: number;
  wire_pieces: number;
}

export interface MeshInfo {
  id: string;
  name: string;
  file_name: string;
  unit: Unit;
  format: string;
  size_bytes: number;
  vertices: number;
  faces: number;
  extents_mm: Vector;
  arrays: VertexArray[];
  /** Of a label volume, a solver's field, a coil, which have no faces; all absent of a mesh. */
  volume?: VolumeInfo;
  field?: FieldInfo;
  coil?: CoilInfo;
  findings: Finding[];
  created: string;
}

export interface Failure {
  code: string;
  class: "input" | "limit" | "state" | "internal";
  message: string;
  retryable: boolean;
}

export interface Job {
  jobID: string;
  processID: string;
  name?: string;
  labels: string[];
  cohortID?: string;
  subject?: string;
  status: JobStatus;
  message: string;
  progress: number;
  created: string;
  started?: string;
  finished?: string;
  updated: string;
  phase?: string;
  queuePosition?: number;
  attempt: number;
  verdict?: Verdict;
  summary?: string;
  failure?: Failure;
  timings_s?: Record<string, number>;
  peakMemoryBytes?: number;
  links: Link[];
}

export interface Link extends ResultReference {
  rel: string;
}

export interface ResultReference {
  href: string;
  type: string;
  title: string;
}

/** JSON Schema as the process descriptions use it, references resolved. */
export interface Schema {
  type?: string | string[];
  title?: string;
  description?: string;
  default?: unknown;
  enum?: unknown[];
  const?: unknown;
  anyOf?: Schema[];
  oneOf?: Schema[];
  allOf?: Schema[];
  properties?: Record<string, Schema>;
  required?: string[];
  items?: Schema;
  additionalProperties?: boolean | Schema;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number | boolean;
  exclusiveMaximum?: number | boolean;
  minItems?: number;
  maxItems?: number;
  pattern?: string;
  contentMediaType?: string;
  nullable?: boolean;
}

export interface ProcessSummary {
  id: string;
  title: string;
  description: string;
  version: string;
}

export interface Process extends ProcessSummary {
  inputs: Record<string, { title: string; description: string; schema: Schema; minOccurs: number }>;
}

export interface MeshNumbers {
  vertices: number;
  faces: number;
  components: number;
  genus: number | null;
  closed: boolean;
  self_intersecting_pairs: number;
  area_mm2: number;
  volume_mm3: number | null;
  quality: { minimum: number; percentile_1: number; median: number; mean: number };
}

export interface PairNumbers {
  a: string;
  b: string;
  relation: string;
  intersecting_pairs: number;
  min_gap_mm: number | null;
  min_gap_point_mm: Vector | null;
}

export interface ThicknessNumbers {
  side: "inside" | "outside";
  target_mm: number;
  on_target_area: number;
  limited_area: number;
  missed_area: number;
  min_mm: number;
  max_mm: number;
}

export interface Report {
  process: string;
  verdict: Verdict;
  summary: string;
  meshes: Record<string, MeshNumbers>;
  pairs: PairNumbers[];
  thickness: Record<string, ThicknessNumbers>;
  /** Of a solver's field, by surface; absent where there is none. */
  fields?: Record<string, { faces: number; too_far: number }>;
  findings: Finding[];
  methods: string;
  parameters: Record<string, unknown>;
  timings_s?: Record<string, number>;
  software: Record<string, string>;
}
