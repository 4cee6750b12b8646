import { useEffect, useRef, useState } from "preact/hooks";
import type { Schema } from "../api/types";
import type { Bounds } from "../mesh/triangles";
import { Failure } from "../parts/failure";
import { middleOf, RegionsInput } from "./regions_input";
import { asRegions, type Region } from "./values";

/** Boxes the server finds by itself, or boxes of one's own. What it would find can be looked at, and taken over. */
export function AutoRegionsInput(props: {
  id: string;
  what: string;
  /** True if leaving the input out means none; else the server finds them unless told otherwise. */
  mayBeNone: boolean;
  schema: Schema;
  value: unknown;
  layers: readonly string[];
  bounds: Bounds | null;
  find: (() => Promise<Region[]>) | null;
  onLook: (point: [number, number, number]) => void;
  onPreview: (regions: Region[]) => void;
  onValue: (value: unknown) => void;
}) {
  const { id, what, value, find, onPreview, onValue } = props;
  const [found, setFound] = useState<Region[] | null>(null);
  const [error, setError] = useState<unknown>(null);
  const [busy, setBusy] = useState(false);
  const newest = useRef(find);
  newest.current = find;
  const own = Array.isArray(value);
  const auto = props.mayBeNone ? value === "auto" : !own;
  useEffect(() => onPreview(auto ? (found ?? []) : []), [auto, found]);
  useEffect(() => () => onPreview([]), []);
  useEffect(() => setFound(null), [find]); // what was found on one mesh is not on another
  const look = async () => {
    setBusy(true);
    setError(null);
    try {
      const regions = (await find?.()) ?? [];
      if (find === newest.current) {
        setFound(regions);
        if (regions[0]) props.onLook(middleOf(regions[0]));
      }
    } catch (reason) {
      setError(reason);
    }
    setBusy(false);
  };
  return (
    <div class="stack">
      <div class="row">
        {props.mayBeNone && (
          <label class="row">
            <input type="radio" name={id} checked={!own && !auto} onChange={() => onValue(undefined)} /> None
          </label>
        )}
        <label class="row">
          <input type="radio" name={id} checked={auto} onChange={() => onValue(props.mayBeNone ? "auto" : undefined)} />{" "}
          Found by the server (auto)
        </label>
        <label class="row">
          <input type="radio" name={id} checked={own} onChange={() => onValue(found ?? [])} /> My own boxes
        </label>
      </div>
      {auto && find && (
        <div class="row">
          <button type="button" disabled={busy} onClick={look}>
            {busy ? "Looking…" : "Show where they are"}
          </button>
          {found && (
            <span class="small" aria-live="polite">
              Found: {found.map((region) => region.name).join(", ")}.
            </span>
          )}
        </div>
      )}
      {error ? <Failure error={error} /> : null}
      {own && (
        <RegionsInput
          what={what}
          schema={props.schema}
          regions={asRegions(value)}
          layers={props.layers}
          bounds={props.bounds}
          onLook={props.onLook}
          onRegions={onValue}
        />
      )}
    </div>
  );
}
