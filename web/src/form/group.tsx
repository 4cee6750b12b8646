import { Field, type FieldProps } from "./field";

/** An object with fields of its own; one that may be left out has a switch. */
export function Group(props: Pick<FieldProps, "schema" | "required" | "value" | "context" | "onValue">) {
  const { schema, required, context, onValue } = props;
  // some groups are in use unless they are left out: null says so
  const given = (props.value === undefined ? schema.default : props.value) as
    | Record<string, unknown>
    | null
    | undefined;
  const used = given !== undefined && given !== null;
  const without = schema.default ? null : undefined;
  return (
    <div class="stack">
      {!required && (
        <label class="row">
          <input
            type="checkbox"
            checked={used}
            onChange={(event) => onValue(event.currentTarget.checked ? {} : without)}
          />
          Use it
        </label>
      )}
      {(required || used) &&
        Object.entries(schema.properties ?? {}).map(([name, one]) => (
          <Field
            key={name}
            name={name}
            schema={one}
            required={schema.required?.includes(name) ?? false}
            value={given?.[name]}
            context={context}
            onValue={(value) => onValue({ ...given, [name]: value })}
          />
        ))}
    </div>
  );
}
