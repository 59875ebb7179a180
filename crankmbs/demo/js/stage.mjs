// The mechanism: draws it at the angle of the slider, and turns it in slow motion.
// Between two samples everything is interpolated; the time of the run says how fast it turns.
export default ({frames, shapes, chosen, angle, play, back, forward, slow, parts, tabs, cursors, readout,
                 polar, tip, canvas, radius, gassed, colours, names, unit, reach}) => {
  // sources change one after the other, the chosen cylinder last: only then all fit together
  let run = frames.data, outlines = shapes.data, own = chosen.data["cylinder"][0] - 1

  const between = (degrees = run["degrees"]) => {
    const sense = degrees[degrees.length - 1] >= degrees[0] ? 1 : -1
    let low = 0, high = degrees.length - 1
    while (high - low > 1) {
      const middle = (low + high) >> 1
      if (sense * degrees[middle] <= sense * angle.value) low = middle
      else high = middle
    }
    const share = (angle.value - degrees[low]) / (degrees[high] - degrees[low])
    return [low, high, Math.min(Math.max(share, 0), 1)]
  }

  const polarTip = () => {
    const {degrees, "simulated x": x, "simulated y": y} = polar.data
    if (degrees === undefined || degrees.length < 2) return {x: 0, y: 0}
    const [low, high, share] = between(degrees)
    return {x: x[low] + share * (x[high] - x[low]), y: y[low] + share * (y[high] - y[low])}
  }

  let longest = 1
  const rescale = () => {  // arrows keep their scale until they outgrow it or become tiny
    let peak = 0
    for (const name of names) {
      const x = run[`${name} x`], y = run[`${name} y`]
      for (let k = 0; k < x.length; k++) peak = Math.max(peak, Math.hypot(x[k], y[k]))
    }
    if (peak > longest || peak < 0.3 * longest || longest === 1) longest = peak || 1
  }

  const follow = () => {  // only what is in sight: every change is a figure painted anew
    for (const cursor of cursors[tabs.active]) cursor.location = angle.value
    if (cursors[tabs.active].length > 0) return
    const {x, y} = polarTip()
    tip.data = {x0: [0], y0: [0], x1: [y], y1: [x]}
  }

  const draw = () => {
    const [low, high, share] = between()
    const at = (name) => {
      const column = run[name]
      return column[low] + share * (column[high] - column[low])
    }
    const count = outlines["piston x"].length
    const order = [...Array(count).keys()].filter((k) => k !== own).concat(own)
    const crank = order.map((k) => [at(`crank x${k}`), at(`crank y${k}`)])
    const pin = order.map((k) => [at(`piston x${k}`), at(`piston y${k}`)])
    const alpha = order.map((k) => (k === own ? 1 : 0.22))
    const piston = (axis, i) => order.map((k, j) => Array.from(outlines[`piston ${axis}`][k], (v) => v + pin[j][i]))
    const px = piston("x", 0), py = piston("y", 1)
    const gas = (axis, corners) => order.map((k, j) => {
      const liner = outlines[`liner ${axis}`][k]
      return [corners[j][1], liner[1], liner[2], corners[j][2]]
    })
    // a figure's x axis is the engine's Y, drawn to the left
    parts.piston.data = {x: py, y: px, alpha}
    parts.gas.data = {x: gas("y", py), y: gas("x", px), pressure: order.map((k) => at(`pressure${k}`)), alpha}
    parts.rod.data = {
      x0: crank.map((p) => p[1]), y0: crank.map((p) => p[0]),
      x1: pin.map((p) => p[1]), y1: pin.map((p) => p[0]), alpha,
    }
    parts.crank.data = {
      x0: order.map(() => 0), y0: order.map(() => 0),
      x1: crank.map((p) => p[1]), y1: crank.map((p) => p[0]), alpha,
    }
    parts.pins.data = {
      x: [...crank.map((p) => p[1]), ...pin.map((p) => p[1]), 0],
      y: [...crank.map((p) => p[0]), ...pin.map((p) => p[0]), 0],
      alpha: [...alpha, ...alpha, 1],
    }
    const last = count - 1
    const middle = (corners) => (corners[last][1] + corners[last][2]) / 2
    const joints = [[0, 0], crank[last], pin[last], pin[last], [middle(px), middle(py)]]
    const arrows = {x0: [], y0: [], x1: [], y1: [], turn: [], size: [], colour: colours}
    const words = []
    names.forEach((name, k) => {
      const x = at(`${name} x`), y = at(`${name} y`), force = Math.hypot(x, y)
      const length = (reach * force) / longest
      const [ux, uy] = force > 0 ? [x / force, y / force] : [0, 0]
      // gas pushes: its arrow ends on the piston
      const [tx, ty] = name === "gas" ? joints[k] : [joints[k][0] + ux * length, joints[k][1] + uy * length]
      arrows.x0.push(ty - uy * length); arrows.y0.push(tx - ux * length)
      arrows.x1.push(ty); arrows.y1.push(tx)
      arrows.turn.push(Math.atan2(ux, -uy) - Math.PI / 2)
      arrows.size.push(length > 0.02 * reach ? 13 : 0)
      words.push(`${name} ${force.toFixed(force < 10 ? 2 : 1)} ${unit}`)
    })
    parts.arrows.data = arrows
    words.push(`speed ${at("speed").toFixed(1)} rpm`)
    const [x, y] = above[own]
    parts.label.data = {x: [y], y: [x], text: gassed ? [`${at("pressure").toFixed(1)} bar`] : [""]}
    readout.data = {...readout.data, text: words}
    follow()
  }

  let above = []  // a little beyond the left end of every head, clear of the arrow of the gas
  const frame = () => {  // equal scales, with room for every cylinder and for the arrows
    const {"liner x": x, "liner y": y} = outlines
    const far = 0.045 * (1.5 * radius + Math.max(...x.flatMap((line) => Array.from(line))))
    above = x.map((line, k) => {
      const [dx, dy] = [line[1] - line[0], y[k][1] - y[k][0]], length = Math.hypot(dx, dy)
      return [line[1] + (far * dx) / length, y[k][1] + (far * dy) / length]
    })
    const along = [-1.5 * radius, 1.3 * radius, ...above.map((p) => p[0] + far / 2), ...outlines["liner x"].flatMap((l) => Array.from(l))]
    const across = [-1.9 * radius, 1.9 * radius, ...outlines["liner y"].flatMap((l) => Array.from(l))]
    const middle = (v) => (Math.max(...v) + Math.min(...v)) / 2
    const half = (v) => (Math.max(...v) - Math.min(...v)) / 2
    const scale = 1.04 * Math.max(half(along) / canvas.height, half(across) / canvas.width)
    const [mx, my, dx, dy] = [middle(across), middle(along), scale * canvas.width, scale * canvas.height]
    canvas.x_range.setv({start: mx + dx, end: mx - dx})
    canvas.y_range.setv({start: my - dy, end: my + dy})
  }

  const time = () => {
    const [low, high, share] = between(), column = run["time"]
    return column[low] + share * (column[high] - column[low])
  }
  const angleAt = (t) => {
    const {time: column, degrees} = run
    let low = 0, high = column.length - 1
    while (high - low > 1) {
      const middle = (low + high) >> 1
      if (column[middle] <= t) low = middle
      else high = middle
    }
    return degrees[low] + ((t - column[low]) / (column[high] - column[low])) * (degrees[high] - degrees[low])
  }
  let before = 0
  const turn = (now) => {
    if (!play.active) return
    const column = run["time"], whole = column[column.length - 1]
    angle.value = angleAt((time() + (now - before) / 1000 / Number(slow.value)) % whole)
    before = now
    requestAnimationFrame(turn)
  }
  play.properties.active.change.connect(() => {
    play.label = play.active ? "❚❚ pause" : "► play"
    before = performance.now()
    if (play.active) requestAnimationFrame(turn)
  })
  const step = (by) => () => {
    play.active = false
    const span = angle.end - angle.start
    const next = Math.round(angle.value - angle.start + by)
    angle.value = angle.start + ((next % span) + span) % span
  }
  back.on_event("button_click", step(-1))
  forward.on_event("button_click", step(1))
  angle.properties.value.change.connect(draw)
  polar.properties.data.change.connect(follow)
  tabs.properties.active.change.connect(follow)
  chosen.properties.data.change.connect(() => {
    [run, outlines, own] = [frames.data, shapes.data, chosen.data["cylinder"][0] - 1]
    frame()
    rescale()
    draw()
  })
  frame()
  rescale()
  draw()
}
