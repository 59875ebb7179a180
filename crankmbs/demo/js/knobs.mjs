// The knobs: one request is under way at a time, and when its answer comes the newest one goes out.
export default ({knobs, choices, reset, request, answer, sources, message}) => {
  const {cylinder, tabs} = choices
  const value = (knob) => ("labels" in knob ? knob.labels[knob.active] : knob.value)
  const initial = Object.fromEntries(Object.entries(knobs).map(([name, knob]) => [
    name, "labels" in knob ? knob.active : knob.value,
  ]))
  let waiting = false, stale = false, number = 0
  const send = () => {
    stale = waiting
    if (waiting) return
    waiting = true
    number += 1
    const values = Object.fromEntries(Object.entries(knobs).map(([name, knob]) => [name, value(knob)]))
    request.data = {json: [JSON.stringify({number, values, cylinder: Number(cylinder.value), tab: tabs.active})]}
  }
  for (const knob of Object.values(knobs)) {
    knob.properties["labels" in knob ? "active" : "value"].change.connect(send)
  }
  cylinder.properties.value.change.connect(send)
  tabs.properties.active.change.connect(send)

  const show = (state) => {
    const block = answer.data["block"][0]
    const part = ({from, to}) => new Float64Array(block.buffer, block.byteOffset + 8 * from, to - from)
    for (const [name, columns] of Object.entries(state)) {
      sources[name].data = Object.fromEntries(Object.entries(columns).map(([key, column]) => [
        key, Array.isArray(column) ? column : part(column),
      ]))
    }
    const count = sources["shapes"].data["liner x"].length
    cylinder.options = [...Array(count).keys()].map((k) => `${k + 1}`)
    cylinder.value = `${sources["chosen"].data["cylinder"][0]}`
  }
  answer.properties.data.change.connect(() => {
    const {error, state} = JSON.parse(answer.data["json"][0])
    message.text = error
    show(state)
    waiting = false
    if (stale) send()
  })
  reset.on_event("button_click", () => {
    for (const [name, knob] of Object.entries(knobs)) {
      if ("labels" in knob) knob.active = initial[name]
      else knob.value = initial[name]
    }
  })
}
