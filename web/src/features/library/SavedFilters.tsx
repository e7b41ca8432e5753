/** Filters and orders that a person comes back to. */
import { ActionIcon, Button, TextInput } from "@mantine/core";
import { useState } from "react";
import { Popup } from "../../ui/Popup";
import { Icon } from "../../ui/theme/Icon";
import { useKeptJson } from "../../ui/use-kept-json";
import styles from "./LibraryPage.module.css";
import { addressOfQuery, queryOf, showQuery, type LibraryQuery } from "./query";
import { readSaved, withFilter } from "./saved-filters";

export function SavedFilters({ query, item, other }: { readonly query: LibraryQuery; readonly item: string; readonly other: string }) {
  const [saved, setSaved] = useKeptJson("becalm-saved-filters", readSaved);
  const [opened, setOpened] = useState(false);
  const [name, setName] = useState("");
  const current = addressOfQuery({ ...query, page: 1 });
  return (
    <Popup opened={opened} onChange={setOpened} target={<Button size="compact-xs" aria-expanded={opened} onClick={() => { setOpened(!opened); }}>Saved filters</Button>}>
      <div className={styles.saved}>
        {saved.length === 0 && <p className={styles.why}>None yet. A name keeps the search, filters and order of now in this browser.</p>}
        <ul>
          {saved.map((each) => (
            <li key={each.name}>
              <Button size="compact-xs" variant={each.address === current ? "filled" : "default"} title={each.address} onClick={() => { setOpened(false); showQuery(queryOf(each.address), item, other); }}>
                {each.name}
              </Button>
              <ActionIcon size={18} variant="subtle" color="gray" aria-label={`Forget the filter ${each.name}`} onClick={() => { setSaved(saved.filter((kept) => kept.name !== each.name)); }}>
                <Icon icon="cross" size={9} />
              </ActionIcon>
            </li>
          ))}
        </ul>
        <form
          className={styles.keep}
          onSubmit={(event) => {
            event.preventDefault();
            if (name.trim() === "") return;
            setSaved(withFilter(saved, name, query));
            setName("");
          }}
        >
          <TextInput aria-label="Name for the present filter" placeholder="Name for the present filter" maxLength={60} value={name} onChange={(event) => { setName(event.currentTarget.value); }} />
          <Button type="submit" disabled={name.trim() === ""}>Save</Button>
        </form>
      </div>
    </Popup>
  );
}
