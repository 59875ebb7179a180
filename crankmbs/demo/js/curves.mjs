// The curves: ranges that stay while a knob is turned, and the quantity and the bearing chosen.
export default ({fits, budget, polar, dead, tops, numbers}) => {
  const fit = ({range, source, columns, least}) => {
    let low = Infinity, high = -Infinity
    for (const name of columns) {
      for (const value of source.data[name]) {
        if (value < low) low = value
        if (value > high) high = value
      }
    }
    if (!(low <= high)) return
    const middle = (low + high) / 2
    const span = Math.max(high - low, least * Math.abs(middle), 1e-9)
    const held = range.end - range.start
    if (low >= range.start && high <= range.end && span > 0.3 * held) return
    range.setv({start: middle - 0.56 * span, end: middle + 0.56 * span})
  }
  for (const item of fits) {
    item.source.properties.data.change.connect(() => fit(item))
    fit(item)
  }

  const name = () => {
    const {x, label} = dead.data
    for (const axis of tops) {
      axis.major_label_overrides = new Map(Array.from(x, (at, k) => [at, label[k]]))
      axis.ticker.ticks = Array.from(x)
    }
  }
  dead.properties.data.change.connect(name)
  name()
  numbers.source.properties.data.change.connect(() => {
    numbers.shown.text = numbers.source.data["text"][0]
  })

  let shownQuantity = ""
  const stack = () => {
    const {store, shown, select, causes, range, axis, units, words, sentences} = budget
    const name = select.value, data = store.data
    const n = data["degrees"].length
    const up = new Float64Array(n), down = new Float64Array(n)
    const columns = {degrees: data["degrees"], total: data[`${name}: lecture minus run`]}
    causes.forEach((cause, k) => {
      const curve = data[`${name}: ${cause}`]
      columns[`up${k} from`] = up.slice()
      columns[`down${k} from`] = down.slice()
      for (let i = 0; i < n; i++) {
        if (curve[i] > 0) up[i] += curve[i]
        else down[i] += curve[i]
      }
      columns[`up${k} to`] = up.slice()
      columns[`down${k} to`] = down.slice()
    })
    shown.data = columns
    axis.axis_label = `${name}: lecture minus run [${units[name]}]`
    if (name !== shownQuantity) range.setv({start: 0, end: 0})
    shownQuantity = name
    const last = causes.length - 1
    fit({range, source: shown, columns: [`up${last} to`, `down${last} to`], least: 0})
    sentences.text = words.data[name]?.[0] ?? ""
  }
  budget.store.properties.data.change.connect(stack)
  budget.words.properties.data.change.connect(stack)
  budget.select.properties.value.change.connect(stack)
  stack()

  let shownBearing = ""
  const choose = () => {
    const {store, shown, marks, select, x_range, y_range} = polar
    const part = (axis, curve) => store.data[`${select.value} force ${axis}, ${curve}`]
    const degrees = store.data["degrees"]
    if (part("x", "simulated") === undefined) return
    const columns = {
      degrees,
      "simulated x": part("x", "simulated"), "simulated y": part("y", "simulated"),
      "lecture x": part("x", "lecture"), "lecture y": part("y", "lecture"),
    }
    shown.data = columns
    const bounds = (names) => {  // the origin belongs to it
      let low = 0, high = 0
      for (const name of names) {
        for (const value of columns[name]) {
          if (value < low) low = value
          if (value > high) high = value
        }
      }
      return {low, high, middle: (low + high) / 2}
    }
    const up = bounds(["simulated x", "lecture x"]), left = bounds(["simulated y", "lecture y"])
    const need = Math.max(up.high - up.low, left.high - left.low) || 1
    const inside = y_range.start <= up.low && up.high <= y_range.end &&
      x_range.end <= left.low && left.high <= x_range.start
    if (select.value !== shownBearing || !inside || need < 0.4 * (y_range.end - y_range.start)) {
      shownBearing = select.value
      x_range.setv({start: left.middle + 0.57 * need, end: left.middle - 0.57 * need})
      y_range.setv({start: up.middle - 0.57 * need, end: up.middle + 0.57 * need})
    }
    const quarters = []
    for (let k = 0; k < degrees.length - 1; k++) {
      if (Math.abs(Math.round(degrees[k] / 90) * 90 - degrees[k]) > 1e-6) continue
      const [x, y] = [columns["simulated y"][k], columns["simulated x"][k]]
      const near = quarters.find((q) => Math.hypot(q.x - x, q.y - y) < 0.05 * need)
      if (near === undefined) quarters.push({x, y, label: `${Math.round(degrees[k])}`})
      else near.label += `, ${Math.round(degrees[k])}`
    }
    marks.data = Object.fromEntries(["x", "y", "label"].map((key) => [key, quarters.map((q) => q[key])]))
  }
  polar.store.properties.data.change.connect(choose)
  polar.select.properties.value.change.connect(choose)
  choose()
}
