import { askJson } from "../api/server";
import type { MeshInfo } from "../api/types";
import { Failure } from "../parts/failure";
import { useLoaded } from "../parts/loaded";

/** The way in: what the server holds. */
export function MeshesPage() {
  const meshes = useLoaded("meshes", (signal) => askJson<{ meshes: MeshInfo[] }>("/v1/meshes?limit=50", { signal }));
  return (
    <>
      <div class="heading">
        <h1>Meshes</h1>
      </div>
      {meshes.error ? <Failure error={meshes.error} again={meshes.again} /> : null}
      {meshes.loading && <p class="empty">Loading…</p>}
      {meshes.value?.meshes.length === 0 && <p class="card empty">Nothing was uploaded yet.</p>}
      <ul class="list">
        {meshes.value?.meshes.map((mesh) => (
          <li key={mesh.id} class="item">
            <span class="name">{mesh.name}</span>
          </li>
        ))}
      </ul>
    </>
  );
}
