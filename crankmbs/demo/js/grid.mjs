// The knobs of a page without a server: every state was computed beforehand and is looked up.
export default ({knobs, states, sources, tabs, message, reset, toml, csv, download, tables, units, stem}) => {
  const initial = knobs.map((knob) => knob.value)
  const state = () => states[knobs.map((knob) => knob.value).join(" | ")]
  let good = state()
  const show = () => {
    const {data, error} = state()
    message.text = error
    if (error) return
    good = state()
    for (const [name, columns] of Object.entries(data)) {
      if (!tables.includes(name)) sources[name].data = columns
    }
    fill()
  }
  const fill = () => {  // of the tabs only the one in sight
    if (good.error) return
    const name = tables[tabs.active]
    sources[name].data = good.data[name]
  }
  tabs.properties.active.change.connect(fill)
  for (const knob of knobs) knob.properties.value.change.connect(show)
  reset.on_event("button_click", () => knobs.forEach((knob, k) => { knob.value = initial[k] }))
  toml.on_event("button_click", () => { download.data = {...good.scene} })
  csv.on_event("button_click", () => {
    const columns = Object.assign({}, ...tables.map((name) => good.data[name]))
    const names = Object.keys(columns).filter((name) => columns[name].length === columns.degrees.length)
    const lines = [names.map((name) => `"${name} [${units[name]}]"`).join(",")]
    for (let k = 0; k < columns.degrees.length; k++) {
      lines.push(names.map((name) => columns[name][k]).join(","))
    }
    const bytes = new TextEncoder().encode(lines.join("\n") + "\n")
    const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")
    download.data = {name: [`${stem}.csv`], base64: [btoa(text)]}
  })
}
