"""Mutants of the page's engine by module: the text as it is, and as the mutant has it.

Over 300 lines, as it is one table.
"""

MUTANTS = {
    "friction": [
        (
            "Math.abs(gas[k] + (shares.length ?",
            "(gas[k] + (shares.length ?",
        ),
        (
            "friction.ring_force * rise + friction.ring_pressure * pressed",
            "friction.ring_pressure * pressed",
        ),
        (
            "Math.abs(tables.gas[k][i] + burning)",
            "Math.abs(tables.gas[k][i])",
        ),
        (
            "friction.ring_force * tables.rise[i] + friction.ring_pressure * pressed",
            "friction.ring_force * tables.rise[i]",
        ),
        (
            "const behind = wrapped(phi + sense * KNOT - top, TURN);",
            "const behind = wrapped(phi - sense * KNOT, TURN);",
        ),
        (
            "behind < bottom - top ? sense : -sense",
            "behind < bottom - top ? 1 : -1",
        ),
        (
            "friction.ring_pressure * Math.abs(gasForce)",
            "friction.ring_pressure * gasForce",
        ),
        (
            "-towards * limit + friction.viscous * x1 * omega",
            "-towards * limit - friction.viscous * x1 * omega",
        ),
        (
            "found.push(wrapped(top + turn - phase, period), wrapped(",
            "found.push(wrapped(0.3 + top + turn - phase, period), wrapped(",
        ),
        (
            "if (value(low) * value(high) < 0)",
            "if (value(low) * value(high) > 0)",
        ),
        (
            "const rises = value(low) < 0;",
            "const rises = false;",
        ),
    ],
    "over_angle": [
        (
            "const turns = repeats ? Math.floor(aim / whole) : 0;",
            "const turns = 0;",
        ),
        (
            "omega, slope * omega];",
            "omega, slope];",
        ),
        (
            "turns * elapsed[elapsed.length - 1] + elapsed[k]",
            "elapsed[k]",
        ),
        (
            "weights[j] / Math.abs(",
            "weights[j] * Math.abs(",
        ),
        (
            "const behind = lead[k] + x;",
            "const behind = x;",
        ),
        (
            "x - late * Math.abs(this.speedIn(k, x)[0])",
            "low",
        ),
        (
            "(3 * a * behind + 2 * b) * behind + c",
            "(3 * a * behind + 2 * b) * behind",
        ),
    ],
    "freed": [
        (
            "speed: meanPrescribed(motion, run, period) }",
            "speed: 1.001 * meanPrescribed(motion, run, period) }",
        ),
        (
            "Math.sign(law.at(0)[1]) * until",
            "until",
        ),
        (
            "inTime ? law.at(until)[0]",
            "inTime ? law.at(0.9 * until)[0]",
        ),
        (
            "const { from } = lastSpan(motion.angle, to, period);",
            "const from = motion.angle;",
        ),
        (
            "law.timeAt(to)) - law.timeAt(from)",
            "law.timeAt(to))",
        ),
        (
            'found.ending === "complete" ? "complete" : "light";',
            '"complete";',
        ),
        (
            "each - friction.viscous * square[i] * speed",
            "each + friction.viscous * square[i] * speed",
        ),
        (
            "(-sense * whole.rise) / section.period",
            "(-0.999 * sense * whole.rise) / section.period",
        ),
        (
            "(-sense * whole.rise) / section.period",
            "-whole.rise / section.period",
        ),
        (
            "torque + (sense * at[1]) / grid",
            "torque + (0 * at[1]) / grid",
        ),
        (
            "const gained = shot.energy - at[0];",
            "const gained = 0.5 * at[0] - shot.energy;",
        ),
        (
            "const late = shot.time - section.period / Math.abs(start.speed);",
            "const late = shot.time - (1.001 * section.period) / Math.abs(start.speed);",
        ),
        (
            "[last, at] = [off, sum(at, step)]",
            "[last, at] = [off, at]",
        ),
        (
            "const scale = 1 / (a * b - 1);",
            "const scale = 0;",
        ),
        (
            "each + scale * (step[i] - said[i]) * row[j]",
            "each - scale * (step[i] - said[i]) * row[j]",
        ),
        (
            "step[0] * b + step[1] * d];",
            "step[1] * b + step[0] * d];",
        ),
        (
            "return [a * x + b * y, c * x + d * y];",
            "return [a * x + c * y, b * x + d * y];",
        ),
        (
            "return [a + factor * c, b + factor * d];",
            "return [a + c, b + d];",
        ),
        (
            "Float64Array.of(torque, 0, 0)",
            "Float64Array.of(0.999 * torque, 0, 0)",
        ),
    ],
    "rebalance": [
        (
            "energy *= (1 + late) ** 2;",
            "energy *= 1;",
        ),
        (
            "share += more;",
            "share -= more;",
        ),
        (
            "side * torque > 0",
            "side * torque !== 0",
        ),
        (
            "(time * Math.abs(speed)) / section.period - 1",
            "0",
        ),
        (
            "share * each",
            "each",
        ),
    ],
    "strong": [
        (
            "Math.abs(jump) + BEND * Math.abs(bend)",
            "BEND * Math.abs(bend)",
        ),
        (
            "strong[0] + knots[n] - knots[0]",
            "strong[0] + 2 * (knots[n] - knots[0])",
        ),
        (
            "seen > STRONG * (high - low)",
            "seen > 20 * STRONG * (high - low)",
        ),
    ],
    "geometry": [
        (
            "if (phi === this.phi)",
            "if (Math.abs(phi - this.phi) < 0.3)",
        ),
        (
            "const sinBeta = (r * sinPhi - e) / l;",
            "const sinBeta = (r * sinPhi + e) / l;",
        ),
        (
            "const beta1 = (r * cosPhi) / (l * cosBeta);",
            "const beta1 = (r * cosPhi) / l;",
        ),
        (
            "const towards = (e >= 0 ? below : above) / l;",
            "const towards = above / l;",
        ),
        (
            "const beta2 = (-r * bend)",
            "const beta2 = (r * bend)",
        ),
        (
            "e * r * towards * towards;",
            "0;",
        ),
        (
            "this.x = r * cosPhi + l * cosBeta;",
            "this.x = r * cosPhi + l;",
        ),
        (
            "-r * sinPhi - l * sinBeta * beta1;",
            "-r * sinPhi + l * sinBeta * beta1;",
        ),
        (
            "this.x2 = -r * cosPhi - l *",
            "this.x2 = -r * cosPhi + l *",
        ),
        (
            "Math.asin(offset / (length + radius)), bottom",
            "0, bottom",
        ),
        (
            "bottom: Math.PI + beyond",
            "bottom: Math.PI",
        ),
        (
            "(length + radius - offset) *",
            "(length + radius) *",
        ),
    ],
    "arrays": [
        (
            "return rest < 0 ? rest + period : rest;",
            "return rest;",
        ),
        (
            "if (values[middle] <= x)",
            "if (values[middle] < x - 1)",
        ),
        (
            "matrix[i * n + k] -= factor *",
            "matrix[i * n + k] += factor *",
        ),
    ],
    "cubics": [
        (
            "if (ahead + first < knots[k]) k = 0;",
            "",
        ),
        (
            "return cubic * x + coefficients[3 * n + k];",
            "return cubic * x;",
        ),
        (
            "coefficients[k] * x + coefficients[n + k]",
            "coefficients[n + k]",
        ),
        (
            "const before = 2 * width[k] + width[k - 1];",
            "const before = width[k];",
        ),
        (
            "if (rise[k - 1] * rise[k] <= 0) continue;",
            "",
        ),
        (
            "cubics[1].push((rise - slope[k]) / width - bend);",
            "cubics[1].push(-bend);",
        ),
        (
            "2 * (width[before(k)] + w)",
            "3 * (width[before(k)] + w)",
        ),
        (
            '"step" ? 0 :',
            '"step" ? 1 :',
        ),
        (
            "return ((near + 2 * both)",
            "return ((near + both)",
        ),
        (
            "if (cut < 0) return rows;",
            "return rows;",
        ),
    ],
    "gas": [
        (
            "const down = within <= centres.bottom;",
            "const down = within <= 3;",
        ),
        (
            "Math.sin(half) ** 2) / (top + at.x)",
            "Math.sin(half) ** 2) / at.x",
        ),
        (
            "const half = 0.5 * (phi + at.beta);",
            "const half = 0.5 * phi;",
        ),
        (
            "Math.atan2(to.offset, x - above)",
            "Math.atan2(0, x - above)",
        ),
        (
            "const over = nearTop * (length + distance - radius);",
            "const over = nearTop * length;",
        ),
        (
            "Math.pow(ratio / volume(phi), source.n_compression)",
            "source.intake_pressure",
        ),
        (
            "source.pre_expansion / volume(phi)",
            "2 * source.pre_expansion / volume(phi)",
        ),
        (
            "Math.pow(size / volume(phi), source.polytrope)",
            "1",
        ),
        (
            "cubic.map((c, j) => c - without[k][j])",
            "cubic",
        ),
        (
            "const gauge = power === 3 ? gas.ambient : 0;",
            "const gauge = 0;",
        ),
        (
            "const first = TURN + source.closes;",
            "const first = TURN;",
        ),
    ],
    "tables": [
        (
            "given - sense * rings - friction.viscous * of.square * omega",
            "given - rings - friction.viscous * of.square * omega",
        ),
        (
            "- friction.viscous * of.square * omega",
            "",
        ),
        (
            "piston.mass * at.x1 * at.x1 + rod",
            "2 * piston.mass * at.x1 * at.x1 + rod",
        ),
        (
            "slope += 2 * rod.inertia * at.beta1 * at.beta2;",
            "",
        ),
        (
            "inertia += rod.inertia * at.beta1 * at.beta1;",
            "",
        ),
        (
            "x1: -r * sinPhi - a * sinBeta * beta1,",
            "x1: -r * sinPhi,",
        ),
        (
            "y1: r * cosPhi - a * cosBeta * beta1,",
            "y1: r * cosPhi,",
        ),
        (
            "y2: -r * sinPhi - a * (cosBeta * beta2",
            "y2: -r * sinPhi - a * (beta2",
        ),
        (
            "+ sinBeta * beta2),",
            "),",
        ),
        (
            "const angle = gravity.angle - bank;",
            "const angle = gravity.angle;",
        ),
        (
            "return first * (gy * Math.cos(theta) - gx * Math.sin(theta));",
            "return 0;",
        ),
        (
            "rod * (ax * gx1[i] + ay * gy1[i]);",
            "rod * ax * gx1[i];",
        ),
        (
            "pistonMass * piston[i] + rodMass * rod[i]",
            "pistonMass * piston[i]",
        ),
        (
            "valuesAlong(cycle, angles, cylinders[k].phase)",
            "valuesAlong(cycle, angles, 0)",
        ),
        (
            "torque += gas[k] ?? 0;",
            "",
        ),
        (
            "burning.push(-piston.area",
            "burning.push(piston.area",
        ),
    ],
    "loads": [
        (
            "branch.c0 + branch.ct * t +",
            "branch.c0 +",
        ),
        (
            "(branch.c1 + branch.c2 * omega) * omega;",
            "branch.c1 * omega;",
        ),
        (
            "return omega === load.until_speed ? OVER : ACTING;",
            "return ACTING;",
        ),
        (
            "t >= (load.after ?? 0) ? ACTING",
            "t >= 0 ? ACTING",
        ),
        (
            "if (load.until !== null && t >= load.until) return OVER;",
            "",
        ),
        (
            "load.over_angle && phases[k] === ACTING",
            "load.over_angle && phases[k] > 9",
        ),
    ],
    "fuel": [
        (
            "return every ? cycle % first === 0",
            "return every ? cycle % first === 1",
        ),
        (
            "const turns = (theta + phase - Math.PI) / this.period;",
            "const turns = (theta + phase) / this.period;",
        ),
        (
            "if (until !== null && time >= until) this.isOver = true;",
            "",
        ),
        (
            "const begun = (this.start.angle + phase - 2 * Math.PI)",
            "const begun = (this.start.angle + phase)",
        ),
    ],
    "rule": [
        (
            "const after = ((2 * j + 1) * z * legendre",
            "const after = ((2 * j) * z * legendre",
        ),
    ],
    "path": [
        (
            "integralTo(rule, cell.torque, first, x);\n  const of",
            "integralTo(rule, cell.torque, 0, x);\n  const of",
        ),
        (
            "(given + outside - 0.5 * of.slope * omega * omega) / of.inertia;\n  return",
            "(given + outside) / of.inertia;\n  return",
        ),
    ],
    "cell": [
        (
            "(branch.c1 + 2 * branch.c2 * omega - drag[j]) / (inertia[j] * omega);",
            "1e9;",
        ),
        (
            "torqueOf(branch, t, omega) - drag[j] * omega;",
            "torqueOf(branch, t, omega);",
        ),
        (
            "given -= sense * ringTorqueIn(friction, tables, i, shares);\n        this",
            "this",
        ),
        (
            "grown += width * rule.weights[j] * rate[j] * right[j];",
            "grown += 0;",
        ),
    ],
    "motion": [
        (
            "this.factor *= this.accelerated(speed) / before;",
            "this.factor *= 2;",
        ),
        (
            "if (time !== null) this.time = time;",
            "if (time !== null) this.time *= 1.01;",
        ),
        (
            "this.energy = 0.5 * inertia * omega * omega;",
            "this.energy *= 1.01;",
        ),
    ],
    "refine": [
        (
            "return { atEnd: errors[s], inside: Math.max(...errors) };",
            "return { atEnd: 0, inside: 0 };",
        ),
    ],
    "settled": [
        (
            "period.sweep(-rise / growth)",
            "period.sweep(-1.1 * rise / growth)",
        ),
        (
            "const step = (motion.time - wanted) / motion.slope;",
            "const step = 0;",
        ),
        (
            "const floor = energy - motion.least;",
            "const floor = energy;",
        ),
        (
            "if (motion.least <= 0) {",
            "if (motion.least <= -Infinity) {",
        ),
        (
            'bracket[gained > 0 ? "low" : "high"] = energy;',
            'bracket[gained > 0 ? "high" : "low"] = energy / 100;',
        ),
        (
            "const step = damping > NONE ? gained / damping : gained * Infinity;",
            "const step = 0;",
        ),
    ],
    "speed": [
        (
            "((a / 4) * x + b / 3) * x + c / 2",
            "((a / 4) * x + b / 3) * x + c",
        ),
        (
            "[angles[k] + turned(cubics[k], x), omega, (3 * a * x",
            "[0, omega, (3 * a * x",
        ),
        (
            "this.rate = Math.sign(m) * order * Math.sqrt(",
            "this.rate = Math.sign(m) * Math.sqrt(",
        ),
        (
            "-this.amplitude * this.order * Math.sin(psi) * omega",
            "-this.amplitude * Math.sin(psi)",
        ),
        (
            "Math.atan2((kappa - 1) * s * c, c * c + kappa * s * s)",
            "Math.atan2(s, c)",
        ),
    ],
    "engine": [
        (
            "quick ? SEEN : DIAGRAM",
            "DIAGRAM",
        ),
        (
            "quick ? this.strong([...pressure, ...combustion]) : pressure",
            "pressure",
        ),
        (
            "quick ? strongOf(tables) : tables",
            "tables",
        ),
        (
            "return { ...found, theta, time: found.time + turns * this.duration - this.late };",
            "return { ...found, theta, time: found.time };",
        ),
        (
            "sense * (theta - all[k].theta) <= SAME",
            "sense * (theta - all[k].theta) <= 1",
        ),
    ],
    "reactions": [
        (
            "const pinX = piston.mass * felt + gas + rubs;",
            "const pinX = piston.mass * felt + gas;",
        ),
        (
            "e * (gas + rubs)",
            "e * gas",
        ),
        (
            "const feltX = g.x2 * square + g.x1 * alpha - gx;",
            "const feltX = g.x2 * square;",
        ),
        (
            "g.y1 * alpha - gy;",
            "g.y1 * alpha;",
        ),
        (
            "const felt = pistonX - gx;",
            "const felt = pistonX;",
        ),
        (
            "piston.mass * felt + gas + rubs;",
            "piston.mass * felt - gas + rubs;",
        ),
        (
            "rod.mass * (at.cosBeta * feltY + at.sinBeta * feltX)",
            "rod.mass * feltY",
        ),
        (
            "(rod.inertia * rodTurn - rod",
            "(rod",
        ),
        (
            "(moment - pinX * at.sinBeta) / at.cosBeta",
            "moment - pinX * at.sinBeta",
        ),
        (
            "const side = -pinY - piston.mass * gy;",
            "const side = -pinY;",
        ),
        (
            "const throwY = rod.mass * feltY + pinY;",
            "const throwY = pinY;",
        ),
        (
            "r * (at.sinPhi * throwX - at.cosPhi * throwY)",
            "r * at.sinPhi * throwX",
        ),
        (
            "moment: -at.x * side - e * (gas + rubs),",
            "moment: -at.x * side,",
        ),
        (
            "return [cos * x - sin * y, sin * x + cos * y];",
            "return [x, y];",
        ),
        (
            "const ownX = first * (-cos * square - sin * alpha)",
            "const ownX = 0",
        ),
        (
            "crank.inertia * alpha - first * (cos * gy - sin * gx)",
            "0",
        ),
        (
            "found.external_torque -= variables.crank_torque;",
            "found.external_torque += variables.crank_torque;",
        ),
        (
            "journal - 0.5 * variables.crank_torque",
            "journal",
        ),
        (
            "found.rocking_moment_x = -about(",
            "found.rocking_moment_x = about(",
        ),
        (
            "topPosition(shape) - at.x,",
            "shape.length + shape.radius - at.x,",
        ),
    ],
    "measures": [
        (
            "fluctuation: (fastest + slowest) / Math.abs(speed)",
            "fluctuation: fastest / speed",
        ),
        (
            "const speed = angle / duration;",
            "const speed = first.omega;",
        ),
        (
            "crank_torque: rods / speed,",
            "crank_torque: rods,",
        ),
        (
            "const ROUGH = 1e-7;",
            "const ROUGH = 1;",
        ),
        (
            "const CLOSENESS = 45;",
            "const CLOSENESS = 2;",
        ),
        (
            "(topPosition(shape) - bottomPosition(shape))",
            "(2 * shape.radius)",
        ),
    ],
    "lecture": [
        (
            "displacement: r * (1 - along) + l * (1 - cosine),",
            "displacement: r * (1 - along),",
        ),
        (
            "((r / l) * along ** 2) / cosine ** 3",
            "(r / l) * along ** 2",
        ),
        (
            "second * omega ** 2 + first * alpha",
            "second * omega ** 2",
        ),
        (
            "const bow = (ratio / 4)",
            "const bow = (ratio / 2)",
        ),
        (
            "(along + ratio * Math.cos(2 * phi) + skew",
            "(along + ratio * Math.cos(2 * phi) - skew",
        ),
        (
            "radial: rod * (along * cosine - across * sine)",
            "radial: rod * along",
        ),
        (
            "rod: net * (1 + (ratio ** 2 / 4) * second),",
            "rod: net,",
        ),
        (
            "radial: net * (along - (ratio / 2) * second",
            "radial: net * (along",
        ),
        (
            "of.tangential * r - atCrankPin * r ** 2 * alpha",
            "of.tangential * r",
        ),
        (
            "const web = (crank.mass * crank.center_of_mass) / shape.radius;",
            "const web = 0;",
        ),
        (
            "return [-inwards * cos - forwards * sin,",
            "return [-inwards * cos,",
        ),
    ],
    "affine": [
        (
            "this.rate[to] = (2 * branch.c2) / this.inertia[to];",
            "this.rate[to] = branch.c2 / this.inertia[to];",
        ),
        (
            "this.push[to] = torque[i] + branch.c0;",
            "this.push[to] = 1.01 * torque[i] + branch.c0;",
        ),
        (
            "this.rise[c] += width * weights[j] * (push[at] + rate[at] * shift[at]);",
            "this.rise[c] += width * weights[j] * push[at];",
        ),
        (
            "growth += own + growth * own;",
            "growth += 0.5 * own;",
        ),
        (
            "own * ((1 + growth) / (1 + after[c]))",
            "own",
        ),
        (
            "torque[k] = push[k] + rate[k] * kinetic;",
            "torque[k] = push[k];",
        ),
        (
            "at.add(this.growth[c] * at.value + this.rise[c]);",
            "at.add(this.rise[c]);",
        ),
    ],
}
