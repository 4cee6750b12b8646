import type { Schema } from "../api/types";
import { AutoRegionsInput } from "./auto_regions_input";
import { ChosenNames } from "./chosen_names";
import type { FieldProps, FormContext } from "./field";
import { Group } from "./group";
import { HoldersInput } from "./holders_input";
import { JsonInput } from "./json_input";
import { LayersTable } from "./layers_table";
import { NamesInput } from "./names_input";
import { NumberInput } from "./number_input";
import { NumbersByName } from "./numbers_by_name";
import type { Placement } from "./placement";
import { PlacementInput } from "./placement_input";
import {
  type Choice,
  hrefOf,
  meshChoices,
  namedReferences,
  packageChoices,
  ReferenceInput,
  ReferencesInput,
  uploadChoices,
} from "./references_input";
import { RegionsInput } from "./regions_input";
import { type Kind, labelOf, regionSchema, type UploadKind } from "./schema_kind";
import { TissuesTable } from "./tissues_table";
import { asLayers, asNumbers, asRegions, asTissues, LARGEST_DEPTH_MM, type Reference } from "./values";
import { WordsInput } from "./words_input";

/** The control an input gets by the kind of its schema. */
export function Control({
  name,
  schema,
  required,
  value,
  context,
  onValue,
  kind,
  id,
}: FieldProps & { kind: Kind; id: string }) {
  const fallback = schema.default;
  switch (kind) {
    case "reference":
    case "package":
    case "volume":
    case "field":
    case "coil":
      return (
        <ReferenceInput
          id={id}
          choices={choicesOf(kind, context)}
          href={hrefOf(value)}
          optional={!required}
          onHref={(href) => onValue(href ? { href } : undefined)}
        />
      );
    case "references":
    case "named_references": {
      const list = Array.isArray(value)
        ? (value as Reference[])
        : Object.values((value ?? {}) as Record<string, Reference>);
      return (
        <ReferencesInput
          label={labelOf(name)}
          choices={meshChoices(context.meshes)}
          chosen={list.map((one) => one.href)}
          onChosen={(hrefs) => {
            if (hrefs.length === 0) onValue(undefined);
            else
              onValue(kind === "references" ? hrefs.map((href) => ({ href })) : namedReferences(hrefs, context.meshes));
          }}
        />
      );
    }
    case "layers":
      return <LayersTable layers={asLayers(value ?? fallback)} arrays={context.arrays} onLayers={onValue} />;
    case "tissues":
      return (
        <TissuesTable
          choices={meshChoices(context.meshes)}
          meshes={context.meshes}
          tissues={asTissues(value ?? fallback)}
          onTissues={(tissues) => onValue(tissues.length ? tissues : undefined)}
        />
      );
    case "regions":
      return (
        <RegionsInput
          what="region"
          schema={regionSchema(schema)!}
          regions={asRegions(value ?? fallback)}
          layers={context.layers}
          bounds={context.bounds}
          onLook={context.onLook}
          onRegions={onValue}
        />
      );
    case "auto_or_regions":
      return (
        <AutoRegionsInput
          id={id}
          what={name === "ears" ? "ear" : "region"}
          mayBeNone={fallback === undefined || fallback === null}
          schema={regionSchema(schema)!}
          value={value}
          layers={context.layers}
          bounds={context.bounds}
          find={name === "ears" ? context.findEars : null}
          onLook={context.onLook}
          onPreview={context.onPreview}
          onValue={onValue}
        />
      );
    case "depths":
      return (
        <NumbersByName
          of={labelOf(name)}
          values={asNumbers(value ?? fallback)}
          names={context.layers}
          min={0}
          max={LARGEST_DEPTH_MM}
          onValues={onValue}
        />
      );
    case "numbers": {
      const each = schema.additionalProperties as Schema;
      return (
        <NumbersByName
          of={labelOf(name)}
          values={asNumbers(value ?? fallback)}
          names={context.surfaces}
          min={each.minimum}
          max={each.maximum}
          whole={each.type === "integer"}
          onValues={(numbers) => onValue(Object.keys(numbers).length > 0 ? numbers : undefined)}
        />
      );
    }
    case "chosen_names":
      return (
        <ChosenNames
          label={labelOf(name)}
          names={context.surfaces}
          chosen={(value ?? []) as string[]}
          onChosen={(names) => onValue(names.length > 0 ? names : undefined)}
        />
      );
    case "holders":
      return (
        <HoldersInput
          of={labelOf(name)}
          names={context.surfaces}
          holders={(value ?? {}) as Record<string, string | null>}
          onHolders={(holders) => onValue(Object.keys(holders).length > 0 ? holders : undefined)}
        />
      );
    case "names":
      return (
        <NamesInput
          of={labelOf(name)}
          names={(value ?? {}) as Record<string, string>}
          labels={context.labels}
          onNames={(names) => onValue(Object.keys(names).length > 0 ? names : undefined)}
        />
      );
    case "choice":
      return (
        <select
          id={id}
          value={String(value ?? fallback ?? "")}
          onChange={(event) => onValue(event.currentTarget.value)}
        >
          {schema.enum!.map((one) => (
            <option key={String(one)}>{String(one)}</option>
          ))}
        </select>
      );
    case "flag":
      return (
        <input
          id={id}
          type="checkbox"
          checked={Boolean(value ?? fallback)}
          onChange={(event) => onValue(event.currentTarget.checked)}
        />
      );
    case "number":
      return (
        <NumberInput
          id={id}
          value={value as number | undefined}
          placeholder={fallback === null || fallback === undefined ? "" : String(fallback)}
          min={schema.minimum}
          max={schema.maximum}
          whole={schema.type === "integer"}
          onValue={onValue}
        />
      );
    case "text":
      return (
        <input
          id={id}
          value={String(value ?? "")}
          placeholder={String(fallback ?? "")}
          onInput={(event) => onValue(event.currentTarget.value || undefined)}
        />
      );
    case "words":
      return <WordsInput id={id} words={(value ?? []) as string[]} onWords={onValue} />;
    case "placement":
      return (
        <PlacementInput
          id={id}
          value={value as Placement | undefined}
          bounds={context.bounds}
          onValue={(placement) => onValue(placement)}
        />
      );
    case "group":
      return <Group schema={schema} required={required} value={value} context={context} onValue={onValue} />;
    case "json":
      return <JsonInput id={id} value={value} fallback={fallback} onValue={onValue} />;
  }
}

function choicesOf(kind: "reference" | "package" | UploadKind, context: FormContext): Choice[] {
  if (kind === "package") return packageChoices(context.jobs);
  return kind === "reference" ? meshChoices(context.meshes) : uploadChoices(context.meshes, kind);
}
