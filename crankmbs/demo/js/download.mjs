// A file that is put into the source goes to the browser's downloads.
export default ({download}) => {
  download.properties.data.change.connect(() => {
    const bytes = Uint8Array.from(atob(download.data["base64"][0]), (c) => c.charCodeAt(0))
    const link = document.createElement("a")
    link.href = URL.createObjectURL(new Blob([bytes]))
    link.download = download.data["name"][0]
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 1000)
  })
}
