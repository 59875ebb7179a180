// The knobs: one request is under way at a time, and when its answer comes the newest one goes out.
export default ({knobs, choices, reset, request, reply}) => {
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
    const {cylinder, tabs} = choices
    request.data = {json: [JSON.stringify({number, values, cylinder: Number(cylinder.value), tab: tabs.active})]}
  }
  for (const knob of Object.values(knobs)) {
    knob.properties["labels" in knob ? "active" : "value"].change.connect(send)
  }
  choices.cylinder.properties.value.change.connect(send)
  choices.tabs.properties.active.change.connect(send)
  reply.properties.data.change.connect(() => {
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
